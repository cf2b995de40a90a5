# The report, single values of it, and the sums of --cost.
source "$(dirname "$0")/../lib.sh"

# 4 x 3 x 2 points far left of where the ball hangs: one level each, and every link leads back.
seed "$ball" --set 'grid.counts=[4,3,2]' --set 'grid.origin=[-0.9,0.0,0.0]' -o seeds
expand --complete seeds -o grid
bytes=$(stat -c %s grid)

# In-box directions: (3 * 4 - 2) (3 * 3 - 2) (3 * 2 - 2) - 24 = 256.
per_record=$(awk -v b="$bytes" 'BEGIN { printf "%.2f", b / 24 }')
megabytes=$(awk -v b="$bytes" 'BEGIN { printf "%.3f", b / 1e6 }')
report="model        hung-ball
parameter    max_force = 3.0
parameter    radius = 0.1
parameter    tolerance = 1e-06
parameter    weight = 1.0
box          4 x 3 x 2 points, 0.05 apart, from (-0.9, 0, 0) to (-0.75, 0.1, 0.05)
state        1 component, tolerance 1e-06 rad
force        1 N on the device for 1 N rope lengths in 1 rope lengths
points       24, of these 24 reached (100.00 %)
records      24 in 2 generations
frontier     0 records (complete)
levels       1: 24 (levels: points that have so many; at most 8)
one-way      0.00 % of 256 links (there and back does not return to the level)
conversions  256 that this grid needed
size         $bytes bytes, $per_record a record

model      avg. levels  data size  CPU hours
hung-ball        1.000   $megabytes MB          -
(average levels: records per point that has a level; data size: the grid as stored, in
10^6 bytes; CPU hours: the sum of --cost)"
expect 0 "$report" '' -- stats grid
expect 0 "$report" '' -- stats <grid
expect 0 "$report" '' -- stats - <grid
expect 0 '' '' -- stats grid -o report
same "the report in a file" "$report" "$(cat report)"

# Single values; those from the footers agree with those from the whole report.
for pair in points=24 records=24 frontier=0 generation=2 generations=2 average_levels=1.0 \
  levels_histogram='[0,24]' conversions=256 one_way_share=0.0 bytes="$bytes" model=hung-ball \
  parameters.radius=0.1 box.spacing=0.05 box.counts='[4,3,2]' cpu_hours=null; do
  expect 0 "${pair#*=}" '' -- stats grid --get "${pair%%=*}"
done
stats grid --format json >json
for key in records frontier generation; do
  grep -qx "  \"$key\": $(stats grid --get $key)," json || fail "$key in the JSON report"
done

# An incomplete grid: 8 corners that were never expanded, each with 7 directions into the box.
for pair in conversions_left=56 frontier=8 generation=0 conversions=0 average_levels=1.0 share_reached=0.3333333333333333 \
  one_way_share=null; do
  expect 0 "${pair#*=}" '' -- stats seeds --get "${pair%%=*}"
done

# Cost files of the tools, and files that are none.
expand seeds --part 1/2 --cost r1 -o q1
expand seeds --part 2/2 --cost r2 -o q2
merge seeds q1 q2 --cost r2 -o second
expect 0 3 '' -- stats second --get costs.lines --cost r1 --cost r2
expect 0 "$(stats second --get conversions)" '' -- \
  stats second --get costs.conversions --cost r1 --cost r2
echo '{"cpu_seconds": 7200, "conversions": 5}' >hours
expect 0 2.0 '' -- stats --get cpu_hours --cost hours grid
stats grid --cost hours | grep -qx 'hung-ball        1.000   [0-9.]* MB        2.0' ||
  fail "CPU hours in the table"
refusals "$here/report.tsv"
