# The hung ball's grid against its closed form (issue 2, point 5): each stored angle is a feasible
# state, and each point has as many levels as states that can be reached there.
source "$(dirname "$0")/../lib.sh"

# The example's own box: from its corners all feasible states are reached.
seed "$ball" | expand --complete -j 2 | dump >whole
python3 "$here/reached.py" all 0.1 0.05 -0.975,-0.475,-0.475 40,20,20 <whole

# Boxes in which some are not, as right of the middle, where the ball is never pushed to the right;
# or that are coarse, short, or at their corners near the ball.
reached() {
  seed "$ball" --set "grid.origin=[$3]" --set "grid.counts=[$4]" --set "grid.spacing=$2" \
    --set "model.parameters.radius=$1" | expand --complete | dump >part
  python3 "$here/reached.py" reached "$@" <part
}
reached 0.1 0.05 0.125,-0.275,-0.275 12,12,9
reached 0.1 0.11 -0.88,-0.55,-0.33 17,11,7
reached 0.15 0.08 -0.36,-0.39,-0.35 9,10,9
reached 0.25 0.12 -0.6,-0.61,-0.1 11,11,10
