# SPDX-License-Identifier: GPL-3.0-or-later
"""A scene that Python steps, and what it records."""

import json
import subprocess
import sys

import calot
import h5py
import numpy as np
import program


def actions(env, steps=120):
    """The right tip goes to the liver and presses; the left one stays."""
    home = env.hands
    surface = env.moment().surfaces["liver"].position
    target = surface[np.argmin(np.linalg.norm(surface - home[1, :3], axis=1))]
    way = np.clip(np.arange(1, steps + 1) / 60, 0.0, 1.1)[:, None]
    made = np.repeat(home[None], steps, 0)
    made[:, 1, :3] += way * (target - home[1, :3])
    made[:, 1, 3], made[:, 1, 4] = 0.2, 0.3
    return made


def driven(path, seed=5, **more):
    env = calot.Environment("touch-liver", seed=seed)
    env.record(path, controller="press", **more)
    env.reset()
    observations = [env.step(a)[0] for a in actions(env)]
    env.close()
    return env, observations


class Record(program.ProgramTest):
    def test_command_line_says_bit_exact(self):
        env, observations = driven(self.path("a.h5"), participant="P1", version="2", purpose="study", handedness="left")
        answer = self.well("replay", "--json", self.path("a.h5"))
        self.assertEqual([(r["verdict"], r["steps"], r["complete"]) for r in json.loads(answer.out)["recordings"]], [("bit-exact", 120, True)])
        with h5py.File(self.path("a.h5"), "r") as file:
            said = {n: (v.decode() if isinstance(v, bytes) else v) for n, v in file.attrs.items()}
        self.assertEqual([said[n] for n in ("operator_kind", "performer_profile", "performer_version", "participant", "purpose", "handedness", "mode", "seed")],
                         ["performer", "controller:press", "2", "P1", "study", "left", "practice", 5])
        r = calot.open(self.path("a.h5"))
        self.assertTrue(r.synthetic)
        self.assertEqual((r.outcome, env.outcome), ("stopped", "stopped"))
        for h, hand in enumerate(("left", "right")):
            self.assertTrue(np.array_equal([o["tip"][h] for o in observations], r.observables[f"{hand}/tip_simulated"]))
            self.assertTrue(np.array_equal([o["structure_force"][h] for o in observations], r.observables[f"{hand}/organ_force"]))
        self.assertGreater(max(o["structure_force"].max() for o in observations), 0.1, "it has to press")
        rounded = np.floor(np.array([o["hand_force"] for o in observations]) / 2.0**-14 + 0.5) * 2.0**-14
        self.assertTrue(np.array_equal(rounded[:, 1], r.forces["right"][9::10]))

    def test_it_is_any_sources_attempt(self):
        driven(self.path("a.h5"))
        cohort = self.path("c.db")
        self.well("assess", self.path("a.h5"), "--cohort", cohort)
        attempts = calot.Cohort(cohort).attempts(frame=False, analysed=False)
        self.assertEqual((list(attempts["synthetic"]), list(attempts["profile"])), ([True], ["controller:press"]))
        self.well("render", self.path("a.h5"), "--at", "1", "--size", "64x36", "-o", self.path("p.png"))
        self.assertIn("controller:press", self.well("inspect", self.path("a.h5")).out + self.well("inspect", "--json", self.path("a.h5")).out)

    def test_twice_the_same_bits(self):
        _, first = driven(self.path("a.h5"))
        _, second = driven(self.path("b.h5"))
        self.assertTrue(all(a[n].tobytes() == b[n].tobytes() for a, b in zip(first, second) for n in a))
        a, b = calot.open(self.path("a.h5")), calot.open(self.path("b.h5"))
        self.assertTrue(np.array_equal(a["/steps/state_digest"], b["/steps/state_digest"]))
        self.assertNotEqual(a.header["attempt_uuid"], b.header["attempt_uuid"])

    def test_all_steps_in_one_call_are_the_same(self):
        env, _ = driven(self.path("a.h5"))
        env.reset()
        rows = env.run(actions(env))
        recorded = calot.open(self.path("a.h5")).observables
        self.assertEqual(len(rows), 120)
        for name in rows.dtype.names:
            self.assertEqual(np.ascontiguousarray(rows[name]).tobytes(), recorded[name].tobytes(), name)

    def test_performer_is_the_command_lines(self):
        said = calot.record(self.path("p.h5"), "touch-liver", "skilled", seed=7, seconds=5)
        self.assertEqual(said, {"outcome": "stopped", "seconds": 5.0})
        here, there = calot.open(self.path("p.h5")), calot.open(program.skilled())
        for path in ("/steps/state_digest", "/steps/force_digest", "/ticks/left/position"):
            self.assertEqual(here[path].tobytes(), there[path].tobytes(), path)

    def test_instruments_buttons_and_camera_are_recorded(self):
        env = calot.Environment("dissect-bed", seed=1)
        env.reset()
        env.record(self.path("a.h5"))  # no step yet: the present attempt
        env.mount("right", "hook")
        camera = calot.Camera.looking([0.0, 0.06, -0.12], [0.0, 0.0, 0.0])
        env.look(camera)
        still = env.hands
        still[1, 5] = calot.COAGULATE + calot.RETRACT_MORE
        env.step(still)
        env.mount("right", "none")
        env.step(env.hands)
        env.finish("abandoned")
        r = calot.open(self.path("a.h5"))
        numbers = calot.instruments()
        self.assertEqual(list(r.tools["right"].instrument[[0, 10]]), [numbers["hook"], numbers["none"]])
        self.assertEqual(set(r.tools["right"].buttons), {calot.COAGULATE + calot.RETRACT_MORE})
        self.assertLess(np.abs(r.camera.position[0] - camera.position).max(), 2.0**-20)
        self.assertLess(np.abs(r.camera.orientation[0] - camera.orientation).max(), 2.0**-15)
        self.assertEqual(r.outcome, "abandoned")
        self.assertEqual(r.verify()["verdict"], "bit-exact")

    def test_what_cannot_be_recorded(self):
        env = calot.Environment("touch-liver")
        with self.assertRaisesRegex(calot.InvalidError, "reset"):
            env.step(np.zeros((2, 6)))
        driven(self.path("a.h5"))
        before = self.path("a.h5").read_bytes()
        env.record(self.path("a.h5"))  # there is no attempt yet: the next one
        with self.assertRaisesRegex(calot.InvalidError, "force=True"):
            env.reset()
        env.step(env.hands)
        self.assertEqual(self.path("a.h5").read_bytes(), before)
        for wrong in (dict(purpose="fun"), dict(handedness="both"), dict(participant="P" * 65)):
            with self.assertRaises(calot.InvalidError):
                env.record(self.path("b.h5"), **wrong)
        env.reset()
        for wrong in (dict(controller=""), dict(controller="a\nb"), dict(version="v" * 65)):
            with self.assertRaisesRegex(calot.InvalidError, "controller"):
                env.record(self.path("b.h5"), **wrong)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["a.h5"])


class Steps(program.ProgramTest):
    def setUp(self):
        super().setUp()
        self.env = calot.Environment("touch-liver", seed=2)

    def test_spaces(self):
        first, info = self.env.reset()
        self.assertEqual(info, {"seed": 2})
        for observed in (first, self.env.step(self.env.hands)[0], self.env.step(self.env.action_space.sample())[0]):
            self.assertEqual(set(observed), set(self.env.observation_space))
            self.assertEqual(set(observed), set(self.env.units))
            for name, array in observed.items():
                self.assertTrue(self.env.observation_space[name].contains(array), name)
        self.assertTrue(self.env.action_space.contains(self.env.hands))
        self.assertEqual(self.env.scene.structures, ("liver", "gallbladder"))

    def test_before_the_first_step(self):
        first, _ = self.env.reset()
        after = self.env.step(self.env.hands)[0]
        self.assertLess(np.abs(first["tip"] - after["tip"]).max(), 1e-5)
        self.assertLess(np.abs(first["insertion"] - after["insertion"]).max(), 1e-5)

    def test_a_wrong_action_changes_nothing(self):
        self.env.reset()
        still = self.env.hands
        for place, number, word in (((0, 0), np.nan, "left hand's.*position"), ((1, 3), np.inf, "right hand's.*roll"), ((1, 5), 64, "buttons"), ((0, 5), -1, "buttons"), ((0, 5), np.nan, "buttons")):
            wrong = still.copy()
            wrong[place] = number
            with self.assertRaisesRegex(calot.InvalidError, word):
                self.env.step(wrong)
        for wrong in (np.zeros(11), np.zeros((3, 6)), np.zeros(0)):
            with self.assertRaisesRegex(calot.InvalidError, r"\(2, 6\)"):
                self.env.step(wrong)
        with self.assertRaisesRegex(calot.InvalidError, "scissors"):
            self.env.mount("left", "spoon")
        self.assertEqual(self.env.step(still)[4]["result"].step, 0)
        self.assertTrue(np.array_equal(self.env.hands, still))

    def test_reward_end_and_limit(self):
        env = calot.Environment("touch-liver", reward=lambda result: result.time, done=lambda result: result.step == 9)
        env.reset()
        told = [env.step(env.hands) for _ in range(10)]
        self.assertEqual([t[1] for t in told], [0.01 * (n + 1) for n in range(10)])
        self.assertEqual([t[2] for t in told], [False] * 9 + [True])
        self.assertEqual(env.outcome, "completed")
        with self.assertRaisesRegex(calot.InvalidError, "completed.*reset"):
            env.step(np.zeros((2, 6)))
        limited = calot.Environment("touch-liver", seconds=0.05)
        limited.reset()
        told = [limited.step(limited.hands) for _ in range(5)]
        self.assertEqual([t[3] for t in told], [False] * 4 + [True])
        self.assertEqual(limited.outcome, "stopped")

    def test_picture_and_result_outlive_the_step(self):
        self.env.reset()
        result = self.env.step(self.env.hands)[4]["result"]
        tip, bytes_then = result["left/tip_simulated"].copy(), result.digest.tobytes()
        moved = self.env.hands
        moved[0, 1] -= 0.005
        self.env.step(moved)
        self.assertTrue(np.array_equal(result["left/tip_simulated"], tip))
        self.assertEqual(result.digest.tobytes(), bytes_then)
        self.assertFalse(np.array_equal(self.env.result["left/tip_simulated"], tip))
        self.assertEqual(self.env.render(64, 36).shape, (36, 64, 3))

    def test_unknown_scene(self):
        said = self.refused(2, "record", "--scene", "nowhere", "--performer", "skilled", "-o", self.path("a.h5"))
        with self.assertRaises(calot.InvalidError) as caught:
            calot.Environment("nowhere")
        self.assertEqual(f"calot: {caught.exception}\n", said.err)
        self.assertIn("touch-liver", calot.scenes())

    def test_gymnasium_where_it_is(self):
        # Gymnasium isn't in Debian: a stand-in with the names that are used shows that its classes are taken.
        package = self.path("gymnasium")
        package.mkdir()
        (package / "__init__.py").write_text("from . import spaces\nclass Env: pass\n")
        (package / "spaces.py").write_text("class Box:\n    def __init__(self, low, high, shape, dtype): self.shape = shape\n"
                                           "class Dict(dict): pass\n")
        code = ("import calot, gymnasium; e = calot.Environment('touch-liver'); e.reset(); e.step(e.hands); "
                "assert isinstance(e, gymnasium.Env) and isinstance(e.action_space, gymnasium.spaces.Box); "
                "assert isinstance(e.observation_space, gymnasium.spaces.Dict)")
        done = subprocess.run([sys.executable, "-c", f"import sys; sys.path.insert(0, {str(self.folder)!r}); {code}"], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))


if __name__ == "__main__":
    program.main()
