"""simulate.py against closed forms and brute force: python3 tests/bench/scaling/simulate_test.py"""
import unittest

import numpy as np

import simulate as s

FREE = dict.fromkeys(("srun", "srun_task", "expand_start", "request_write", "merge_start", "request_merge",
                      "record_copy", "request_file", "driver"), 0.0)
EVEN = s.Times([1], 0.056)


def rng():
    return np.random.default_rng(3)


class Simulation(unittest.TestCase):
    uneven = s.Times(rng().lognormal(0, 1, 500), 0.056)

    def test_one_worker_takes_the_sum_of_all(self):
        efficiency, serial = s.build([56, 880, 17], 1, 1, FREE, self.uneven, rng())
        self.assertAlmostEqual(efficiency, 1)
        self.assertEqual(serial, 0)

    def test_all_costs(self):
        costs = dict(zip(FREE, (2, 3, 5, 7, 11, 13, 17, 19, 23)))
        parts, merge, work = s.round_seconds(400, 30, 4, 1, costs, EVEN, rng())
        self.assertAlmostEqual(work, 400 * 0.056)
        self.assertAlmostEqual(parts, 100 * 0.056 + 100 * 7 + 2 + 3 * 3 + 5)  # of the part that starts last
        self.assertAlmostEqual(merge, 11 + 400 * 13 + 30 * 17 + 4 * 19 + 23)

    def test_even_times_in_a_multiple_of_the_workers_are_ideal(self):
        for workers in 1, 8, 40:
            self.assertAlmostEqual(s.build([1024 * 40, 1024 * 120], workers, 1, FREE, EVEN, rng())[0], 1)

    def test_what_cannot_be_shared(self):
        # 7 equal conversions for 4 workers take two turns; 5 for 99 one.
        self.assertAlmostEqual(s.round_seconds(7, 0, 4, 1, FREE, EVEN, rng())[0], 2 * 0.056)
        self.assertAlmostEqual(s.round_seconds(5, 0, 99, 1, FREE, EVEN, rng())[0], 0.056)
        # Even times: 4 threads do 400 conversions in the time of 100 + 3/4 at most.
        self.assertAlmostEqual(s.round_seconds(400, 0, 4, 4, FREE, EVEN, rng())[0], 100.75 * 0.056)

    def test_deal_is_that_of_expand(self):
        """Part k gets each block b with b mod N = k: counted one by one."""
        for conversions, parts in (7, 3), (64 * 5, 5), (64 * 5 * 3 + 17, 5), (100000, 7), (400000, 7), (3, 3):
            block = s.block_size(conversions, parts)
            expected = np.bincount(np.arange(conversions) // block % parts, minlength=parts)
            work, slowest, sizes = s.deal(conversions, parts, EVEN, rng())
            self.assertEqual(list(sizes), list(expected))
            self.assertTrue(np.allclose(work, sizes * 0.056))
            self.assertTrue(np.allclose(slowest, 0.056))

    def test_stretches(self):
        sequence = rng().exponential(1, 37)
        times = s.Times(sequence, sequence.mean())
        for count in 1, 2, 5, 36, 37, 80:
            begin = rng().integers(37, size=20)
            for b, total, most in zip(begin, *times.stretches(begin, count)):
                stretch = np.take(sequence, range(b, b + count), mode="wrap")
                self.assertAlmostEqual(total, stretch.sum())
                self.assertAlmostEqual(most, stretch.max())

    def test_growth_is_all_pairs_of_neighbours_and_few_second_levels(self):
        for n, rounds in s.read_growth().items():
            pairs = (3 * n - 2) ** 3 - n**3
            self.assertTrue(pairs < sum(rounds) < 1.1 * pairs)


if __name__ == "__main__":
    unittest.main()
