"""The hung ball in closed form (Sect. 2.1 of the paper), in angles, as issue 2 writes it. Nothing of hapgrid is used."""
import math


def arc(p, radius=0.1):
    """(φ, δ): the balls overlap for |α - φ| < δ. None without such an arc."""
    x, y, z = p
    m = 4 * radius * radius - y * y
    rho = math.hypot(x, 1 - z)
    if m <= 0 or rho == 0:
        return None
    cosine = (1 + rho * rho - m) / (2 * rho)
    if cosine >= 1:
        return None
    return math.atan2(x, 1 - z), math.acos(max(cosine, -1.0))


def contact(p, radius=0.1):
    """The angle of a ball pushed from the left; None where the balls do not touch on that branch."""
    here = arc(p, radius)
    return None if here is None else here[0] + here[1]


def force_and_energy(p, radius=0.1):
    """Force x, y, z and energy of a ball of weight 1 pushed from the left."""
    angle = contact(p, radius)
    sine, cosine = math.sin(angle), math.cos(angle)
    u = [sine - p[0], -p[1], 1 - cosine - p[2]]
    push = sine / (u[0] * cosine + u[2] * sine)  # over |u|, which is 2 R
    return [-push * c for c in u] + [1 - cosine]


def settle(alpha, p, radius):
    here = arc(p, radius)
    if here is None:
        return 0.0
    phi, delta = here
    to = max(0.0, phi + delta) if alpha >= phi else min(0.0, phi - delta)
    return to if abs(to) < math.pi else 0.0


def convert(alpha, p, d, radius):
    steps = math.ceil(math.sqrt(sum(c * c for c in d)) / (radius / 16))
    if arc([a + b for a, b in zip(p, d)], radius) is None:
        return 0.0
    for k in range(1, steps + 1):
        alpha = settle(alpha, [a + k / steps * b for a, b in zip(p, d)], radius)
    return alpha


def feasible(p, radius):
    """S(x)."""
    here = arc(p, radius)
    if here is None:
        return [0.0]
    phi, delta = here
    states = [0.0] if abs(phi) >= delta else []
    states += [phi + delta] if 0 < phi + delta < math.pi else []
    states += [phi - delta] if -math.pi < phi - delta < 0 else []
    return states
