#!/usr/bin/env bash
# The round trip of an adapter in C and of one in Python at 1 and 4 kHz, beside a path device's, as a histogram.
#
#   tests/bench/process.sh [BUILD] [SECONDS] [PICTURE]        (default: build 20 round-trip.png)
#
# The adapter in C is Force Dimension's before the stand-in for its kit, which takes no time: what is measured is the
# protocol, without a device. Run it as root, or with the limits that real time needs.
seconds=${2:-20} picture=$(realpath "${3:-round-trip.png}")
source "$(dirname "$0")/lib.sh"
export HAPGRID_KIT=/dev/null

for rate in 1000 4000; do
  for device in path c python; do
    case $device in
      path) command=(path) ;;
      c) command=("$HAPGRID_BUILD/tests/devices/force-dimension") ;;
      python) command=(/usr/bin/python3 "$HAPGRID_SOURCE/examples/devices/handle.py") ;;
    esac
    "$HAPGRID_BUILD/bench/bench_round_trip" "$rate" "$seconds" "${command[@]}" >"$device.$rate" 2>err || fail "$(cat err)"
    # Bins of a tenth of a decade.
    awk '/^#/ { next } { n[int(10 * log($1 + 1e-9) / log(10) + 1000)] += $2 }
         END { for (b in n) print 10 ^ ((b - 999.5) / 10), 100 * n[b] }' "$device.$rate" | sort -g >"$device.$rate.bins"
    echo "$rate Hz, $device: $(sed -n 's/^# //p' "$device.$rate")"
  done
done
gnuplot <<PLOT
set terminal pngcairo size 900,330 font "DejaVu Sans,10"
set output "$picture"
set multiplot layout 1,2
set logscale x
set xrange [0.01:1000]
set yrange [0:]
set xlabel "round trip / µs"
set ylabel "% of the ticks"
set boxwidth 0.18 relative
set style fill transparent solid 0.6
set key top left
do for [rate in "1000 4000"] {
  set title sprintf("%s Hz", rate)
  plot for [d in "path c python"] sprintf("%s.%s.bins", d, rate) using 1:2:(0.2*\$1) with boxes \
    title d eq "path" ? "path" : d eq "c" ? "adapter in C" : "adapter in Python"
}
PLOT
