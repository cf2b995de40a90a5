"""A truss that SciPy's BFGS relaxes: it leaps over the barrier, at places that depend on the steps of the HIP. With relax()
it snaps at the limit point of the closed form, whatever the steps. check-model says so of both: check-model/mistakes.sh.
"""
import math


def test_truss(needs):
    needs("scipy", "python3-scipy")
    from models.truss import Truss

    # The force of the bars on the apex at height w is F(w) = 2 EA w (1/L0 - 1/L), L² = 1 + w². The apex snaps where
    # F' + tie = 0: 1/L³ = 1/L0 + tie / (2 EA); the HIP is then at w + F(w) / tie.
    w = math.sqrt((1 / (1 / Truss.rest + Truss.tie / (2 * Truss.bars)))**(2 / 3) - 1)
    limit = w + 2 * Truss.bars * w * (1 / Truss.rest - 1 / math.hypot(1, w)) / Truss.tie

    def snap(minimiser, substep):
        s, z = [0.0, Truss.height], Truss.height
        while s[1] > 0:
            s = Truss(minimiser, substep).convert(s, [0, 0, z], [0, 0, -substep])
            z -= substep
        return z

    # The HIP looks every substep, and so the first place behind the limit is where it snaps.
    for substep in 0.4, 0.2, 0.1, 0.05, 0.02:
        z = snap("relax", substep)
        assert limit - substep - 1e-3 < z < limit + 1e-3, (substep, z, limit)
    leaps = [snap("BFGS", substep) for substep in (0.4, 0.3, 0.2)]
    assert max(leaps) > limit + 0.1 and len({round(z, 2) for z in leaps}) > 1, (leaps, limit)
