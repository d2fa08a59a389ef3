# SPDX-License-Identifier: GPL-3.0-or-later
"""Other threads go on while the libraries compute, and each may have recordings of its own."""

import sys
import threading
import time

import calot
import numpy as np
import program


class Counter(threading.Thread):
    """Counts whenever it is let."""

    def __init__(self):
        super().__init__(daemon=True)
        self.count, self.over = 0, False

    def run(self):
        while not self.over:
            self.count += 1
            time.sleep(0)


class Threads(program.ProgramTest):
    def setUp(self):
        super().setUp()
        # A thread gives way only where it waits or releases the interpreter by itself.
        interval = sys.getswitchinterval()
        sys.setswitchinterval(1000.0)
        self.addCleanup(sys.setswitchinterval, interval)
        self.counter = Counter()
        self.counter.start()
        self.addCleanup(self.stop)

    def stop(self):
        self.counter.over = True
        self.counter.join()

    def counted(self, call):
        before = self.counter.count
        call()
        return self.counter.count - before

    def assertMovesOn(self, call):
        """The counter counts during `call`. On a busy machine it may find no processor in time: the call gets several tries."""
        counts = []
        while len(counts) < 20 and sum(counts) <= 5:
            counts.append(self.counted(call))
        self.assertGreater(sum(counts), 5, counts)

    def test_the_counter_stands_still_where_nothing_is_released(self):
        self.assertEqual(self.counted(lambda: sum(n * n for n in range(100000))), 0)

    def test_the_interpreter_is_free_meanwhile(self):
        r = calot.open(program.skilled())
        env = calot.Environment("touch-liver")
        env.reset()
        still = np.repeat(env.hands[None], 500, 0)
        moment = r.seek(1.0)
        for name, call in (("open", lambda: calot.open(program.skilled())), ("arrays", lambda: r["/ticks/left/jaw"]), ("verify", r.verify),
                           ("replay", lambda: r.replay().advance(300)), ("seek", lambda: r.seek(3.0)), ("render", lambda: moment.render(320, 180)),
                           ("assess", lambda: calot.assess(program.skilled())), ("run", lambda: env.run(still)), ("reset", env.reset),
                           ("record", lambda: calot.record(self.path("a.h5"), "touch-liver", seconds=1))):
            with self.subTest(name):
                self.assertMovesOn(call)
        with self.subTest("step"):
            self.assertMovesOn(lambda: [env.step(still[0]) for _ in range(200)])

    def test_recordings_of_their_own(self):
        alone = [[x.digest.tobytes() for x in calot.open(file).replay()] for file in (program.skilled(), program.short())]
        got, failures = {}, []

        def work(number):
            try:
                r = calot.open((program.skilled(), program.short())[number % 2])
                got[number] = [x.digest.tobytes() for x in r.replay()]
                r.seek(0.3).state
            except BaseException as e:  # noqa: BLE001  (a thread's failure is the test's)
                failures.append(e)

        threads = [threading.Thread(target=work, args=(n,)) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        self.assertEqual([got[n] == alone[n % 2] for n in range(4)], [True] * 4)

    def test_one_recording_for_several(self):
        r = calot.open(program.skilled())
        moments = {}
        threads = [threading.Thread(target=lambda s=s: moments.update({s: r.moment(s)})) for s in (400, 30, 250, 120)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual({s: m.step for s, m in moments.items()}, {s: s for s in (400, 30, 250, 120)})
        tips = r.observables["right/tip_simulated"]
        self.assertTrue(all(np.array_equal(m.instruments["right"].position, tips[s]) for s, m in moments.items()))


if __name__ == "__main__":
    program.main()
