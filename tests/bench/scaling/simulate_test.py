"""simulate.py against closed forms and brute force."""
import unittest

import numpy as np

import simulate as s

FREE = s.Costs()
NOBODY = s.Way()


def rng():
    return np.random.default_rng(3)


def rounds(*conversions):
    return [s.Round(c, 4, (c + 3) // 4) for c in conversions]


def build(rounds_, workers, parts, times, way=NOBODY, costs=FREE, ranges=0, **more):
    return s.build(rounds_, workers, lambda c: s.equal_parts(c, parts), ranges, way, costs, times,
                   rng(), **more)


def naive(workers, work, serial, own):
    """List scheduling with a look at all workers for each shard."""
    free = [0.0] * workers
    gate = 0.0
    for seconds in work:
        w = min(range(workers), key=lambda i: free[i])
        gate = max(free[w], gate) + serial
        free[w] = gate + own + seconds
    return max(free)


class Simulation(unittest.TestCase):
    uneven = s.Times(rng().lognormal(0, 1, 500), 0.056)
    even = s.Times([1], 0.056)

    def test_one_worker_takes_the_sum_of_all(self):
        r = build(rounds(56, 880, 17), 1, 5, self.uneven)
        self.assertAlmostEqual(r.wall, r.busy, places=9)
        way = s.Way(serial=2, own=3, launch=5, once=7)
        costs = s.Costs(request_write=.5, request_merge=.25, chunk_merge=11, merge_start=13,
                        request_file=17, sync=19, driver_round=23, driver_part=29)
        r = build(rounds(50, 100), 1, 5, self.uneven, way, costs)
        each = 5 * (2 + 3 + 17 + 19 + 29) + 2 * 19 + 5 + 4 * 11 + 13 + 23
        self.assertAlmostEqual(r.wall, r.busy + 7 + 2 * each + 150 * .75, places=6)

    def test_a_driver_that_looks_again_and_again_is_late_by_half_a_nap(self):
        r = build(rounds(1000), 1, 5, self.even, s.Way(watch=True))
        self.assertAlmostEqual(r.wall, 56 + (0.02 + 0.56) / 2)
        r = build(rounds(100000), 1, 5, self.even, s.Way(watch=True))
        self.assertAlmostEqual(r.wall, 5600 + 0.9 / 2)

    def test_workers_without_end_leave_the_slowest_conversions(self):
        times = s.Times([1, 1, 1, 5], 2)
        r = build(rounds(100, 1000, 300), 1000, 1000, times)
        self.assertAlmostEqual(r.wall, 3 * 5)
        self.assertAlmostEqual(build(rounds(9, 99), 99, 99, self.even).wall, 2 * 0.056)

    def test_even_times_in_a_multiple_of_the_workers_are_ideal(self):
        for workers in 1, 8, 40:
            r = build(rounds(800, 8000), workers, 2 * workers, self.even)
            self.assertAlmostEqual(r.wall, 8800 * 0.056 / workers)
            self.assertAlmostEqual(r.spent["tail"], 0)

    def test_what_cannot_be_shared(self):
        # 7 equal conversions for 4 workers take two turns.
        self.assertAlmostEqual(build(rounds(7), 4, 7, self.even).wall, 2 * 0.056)
        # One that hands out, no work: as many times in a row.
        self.assertAlmostEqual(s.hand_out([0.0] * 50, [0.0] * 30, 2, 0), 60)
        # One processor for all that is handed out; two.
        self.assertAlmostEqual(s.hand_out([0.0] * 50, [0.0] * 30, 0, 2, 1), 60)
        self.assertAlmostEqual(s.hand_out([0.0] * 50, [0.0] * 30, 0, 2, 2), 30)

    def test_brute_force_and_grahams_bound(self):
        r = rng()
        for _ in range(200):
            workers = int(r.integers(1, 7))
            work = r.exponential(1, int(r.integers(1, 30)))
            serial, own = r.choice([0, .1, 1], 2)
            end = s.hand_out([0.0] * workers, work, serial, own)
            self.assertAlmostEqual(end, naive(workers, work, serial, own), places=9)
            if serial == 0:
                work = work + own
                self.assertGreaterEqual(end + 1e-9, max(work.max(), work.sum() / workers))
                bound = work.sum() / workers + (1 - 1 / workers) * work.max()
                self.assertLessEqual(end, bound + 1e-9)

    def test_nothing_is_lost(self):
        for cut in (lambda c: s.equal_parts(c, 64), lambda c: s.guided_parts(c, 16, 2, 3)):
            way = s.Way(serial=.001, own=.01, launch=.1, launch_task=.01, poll=.1, once=1)
            r = s.build(rounds(1, 5000, 300), 16, cut, 4, way, s.Costs(request_merge=1e-4), self.even,
                        rng())
            self.assertEqual(r.conversions, 5301)
            self.assertAlmostEqual(r.busy, 5301 * 0.056)
            self.assertAlmostEqual(sum(r.spent.values()), r.wall)
            self.assertGreater(r.wall, r.busy / 16)

    def test_ranges_share_a_merge(self):
        costs = s.Costs(request_merge=1)
        for ranges, share in (0, 1), (1, 3), (4, 3 / 4):
            r = build(rounds(400), 400, 400, s.Times([1], 0), costs=costs, ranges=ranges)
            # A range reads what both neighbours get, too.
            self.assertAlmostEqual(r.wall, 400 * share)

    def test_parts(self):
        self.assertEqual(list(s.equal_parts(10, 4)), [2, 3, 2, 3])
        self.assertEqual(list(s.equal_parts(2, 4)), [1, 1])
        sizes = s.guided_parts(100000, 10, 4, 5)
        self.assertEqual(sizes.sum(), 100000)
        self.assertEqual(sizes[0], 2500)
        self.assertTrue((np.diff(sizes) <= 0).all())
        self.assertTrue((sizes[:-1] >= 5).all())

    def test_times(self):
        sequence = np.array([1.0, 2, 6])
        times = s.Times(sequence, 3)
        for count, sums, slowest in ((1, {1, 2, 6}, {1, 2, 6}), (2, {3, 8, 7}, {2, 6}),
                                     (13, {37, 38, 42}, {6})):
            got = times.shards(np.full(100, count), rng())
            self.assertEqual((set(got[0]), set(got[1])), (sums, slowest))
        long = rng().exponential(1, 37)
        counts = np.arange(1, 90)
        begins = rng().integers(37, size=89)
        for begin, count, total, most in zip(
                begins, counts, *s.Times(long, long.mean()).shards(counts, rng())):
            stretch = np.take(long, range(begin, begin + count), mode="wrap")
            self.assertAlmostEqual(total, stretch.sum())
            self.assertAlmostEqual(most, stretch.max())
        self.assertAlmostEqual(s.Times(sequence, 0.056).shards(np.array([300]), rng())[0][0], 16.8)

    def test_threads_of_a_task(self):
        # Even times: 4 threads do 4 conversions in the time of 1 + 3/4 at most, and of 1 at least.
        r = build(rounds(400), 4, 1, self.even, threads=4)
        self.assertAlmostEqual(r.wall, (100 + .75) * 0.056)
        self.assertAlmostEqual(build(rounds(400), 400, 100, self.even, threads=4).wall, 1.75 * 0.056)

    def test_the_same_seed_gives_the_same(self):
        a, b = (build(rounds(900, 90), 7, 21, self.uneven, s.Way(poll=.1)) for _ in range(2))
        self.assertEqual((a.wall, a.busy), (b.wall, b.busy))


class Growth(unittest.TestCase):
    growth = s.read_growth(s.HERE / "growth.txt")

    def test_alone_it_grows_from_its_corners(self):
        for n in 30, 50:
            edge = np.minimum(np.arange(n), np.arange(n)[::-1])
            i, j, k = np.meshgrid(edge, edge, edge)
            generation = np.maximum(np.maximum(i, j), k)
            neighbours = (3 - (i == 0)) * (3 - (j == 0)) * (3 - (k == 0)) - 1
            expected = np.bincount(generation.ravel(), neighbours.ravel())
            self.assertEqual([r.conversions for r in self.growth["alone", n]], list(expected))

    def test_all_pairs_of_neighbours(self):
        for (grid, n), grown in self.growth.items():
            pairs = (3 * n - 2) ** 3 - n**3
            total = sum(r.conversions for r in grown)
            self.assertTrue(total == pairs if grid == "alone" else pairs < total < 1.1 * pairs)

    def test_thinned(self):
        all_ = self.growth["ball", 128]
        few = s.thinned(all_, 20)
        self.assertEqual(len(few), 20)
        total = sum(r.conversions for r in all_)
        self.assertAlmostEqual(sum(r.weight * r.conversions for r in few), total, delta=1e-6 * total)


if __name__ == "__main__":
    unittest.main()
