# SPDX-License-Identifier: GPL-3.0-or-later
# %% [markdown]
# # Hand motion as a BIDS data set
#
# `bids_dataset.py OUT [--cohort C.db [--key KEY]] R.h5...` writes the motion of recordings as a data set of the Brain Imaging Data Structure 1.9.0, modality "motion"
# (Jeung et al. 2024, Scientific Data 11:716). Without arguments it makes three recordings of performers and a data set of them, in a
# folder that goes away.
#
# A row is a tick each 10 ms: position of each mounted instrument's tip (m, world frame) and its orientation (unit quaternion), as they were
# recorded; n/a where the sample is not valid. Labels are letters and digits, as BIDS asks; two names that become one label are refused.
# Runs are numbered by start. Dates and uuids are left out. With a cohort, only attempts that `calot study` analyses are written, and the
# export is registered there; without one, consent and withdrawal are not known.

# %%
import json
import pathlib
import re
import sys
import tempfile

import calot
import numpy as np

TICKS_PER_ROW = 10  # of 1 ms
RATE = 100.0
README = """Motion of laparoscopic instruments in simulated tasks, recorded by Calot.

Positions (m) and orientations (unit quaternions, instrument to world) of the instruments' tips in the frame of the world (x to the patient's
right, y anterior, z cranial), one sample in ten of those recorded at 1 kHz, not filtered. n/a: not measured. Dates are left out. `synthetic`
in participants.tsv says whose motion was made by a program.
"""


def fail(text: str) -> None:
    sys.exit(f"bids_dataset: {text}")


# %%
class Labels:
    """Names as labels of letters and digits."""

    def __init__(self) -> None:
        self.taken: dict[str, str] = {}

    def of(self, name: str, what: str) -> str:
        label = re.sub("[^0-9A-Za-z]", "", name)
        if not label:
            fail(f"\"{name}\" names no {what}")
        if self.taken.setdefault(label, name) != name:
            fail(f"{what} \"{self.taken[label]}\" and \"{name}\" have the same label \"{label}\"")
        return label


def participant_of(recording: calot.Recording) -> str:
    return recording.participant or (str(recording.header["performer_profile"]) if recording.synthetic else "")


def channels_of(recording: calot.Recording) -> tuple[list[list[str]], np.ndarray]:
    """Rows of the channel table, and their columns of numbers (NaN: not valid)."""
    channels, columns = [], []
    for hand, tool in recording.tools.items():
        valid = np.asarray(tool.valid)[::TICKS_PER_ROW].astype(bool)
        if not valid.any():
            continue
        for axis, name in enumerate("xyz"):
            channels.append([f"{hand}_{name}", name, "POS", f"{hand}_tip", "m", "world"])
            columns.append(np.where(valid, tool.position[::TICKS_PER_ROW, axis], np.nan))
        for part, name in enumerate(("quat_w", "quat_x", "quat_y", "quat_z")):
            channels.append([f"{hand}_{name}", name, "ORNT", f"{hand}_tip", "n/a", "world"])
            columns.append(np.where(valid, tool.orientation[::TICKS_PER_ROW, part], np.nan))
    if not channels:
        fail(f"{recording.path}: holds no motion of an instrument")
    return channels, np.column_stack(columns)


def write_run(base: pathlib.Path, recording: calot.Recording, device: str) -> None:
    """The four files of one recording."""
    channels, numbers = channels_of(recording)

    def count(kind: str) -> int:
        return sum(c[2] == kind for c in channels)
    note = "Tips of the instruments in the frame of the scene's world." + (" Synthetic: made by a performer, not by a person." if recording.synthetic else "")
    about = {"TaskName": recording.scene, "TaskDescription": note, "SamplingFrequency": RATE, "RecordingDuration": len(numbers) / RATE,
             "RecordingType": "continuous", "MissingValues": "n/a", "MotionChannelCount": len(channels), "POSChannelCount": count("POS"),
             "ORNTChannelCount": count("ORNT"), "TrackedPointsCount": count("POS") // 3, "TrackingSystemName": device,
             "SoftwareVersions": str(recording.header["software"])}
    frames = {"reference_frame": {"Description": "frame that positions and orientations are given in",
                                  "Levels": {"world": {"RotationRule": "right-hand"}}}}
    header = ["name", "component", "type", "tracked_point", "units", "reference_frame"]
    rows = (["n/a" if np.isnan(v) else repr(float(v)) for v in row] for row in numbers)
    write(pathlib.Path(f"{base}_motion.tsv"), rows)
    write(pathlib.Path(f"{base}_channels.tsv"), [header, *channels])
    write_json(pathlib.Path(f"{base}_motion.json"), about)
    write_json(pathlib.Path(f"{base}_channels.json"), frames)


def write(path: pathlib.Path, rows) -> None:
    with open(path, "x", encoding="utf-8") as file:
        for row in rows:
            file.write("\t".join(row) + "\n")


def write_json(path: pathlib.Path, value: object) -> None:
    path.write_text(json.dumps(value, indent=2) + "\n", encoding="utf-8")


# %%
def analysed(recordings: list[calot.Recording], cohort: str, key: str) -> list[calot.Recording]:
    """Those in the cohort's analysis set, of one comparability key."""
    known = calot.Cohort(cohort).attempts(frame=False, key=key)
    keys = dict(zip(known["attempt"], known["key"]))
    kept = [r for r in recordings if r.header["attempt_uuid"] in keys]
    several = sorted({keys[r.header["attempt_uuid"]] for r in kept})
    if len(several) != 1:
        fail(f"{cohort}: the recordings in its analysis set have {len(several)} comparability keys, one is expected: {'; '.join(several)}")
    print(f"{len(kept)} of {len(recordings)} recordings are in the analysis set of {cohort}", file=sys.stderr)
    return kept


def write_dataset(out: pathlib.Path, files: list[pathlib.Path], cohort: str = "", key: str = "") -> None:
    recordings = [calot.open(file) for file in files]
    if cohort:
        recordings = analysed(recordings, cohort, key)
    for recording in recordings:
        if not recording.chain_intact:
            fail(f"{recording.path}: its content was changed since it was recorded")
        if not participant_of(recording):
            fail(f"{recording.path}: names no participant")
    recordings.sort(key=lambda r: (participant_of(r), str(r.header["start_utc"])))
    subjects, tasks, systems = Labels(), Labels(), Labels()
    synthetic: dict[str, bool] = {}
    runs: dict[str, int] = {}
    out.mkdir()
    for recording in recordings:
        device = str(recording.header["device"]) or str(recording.header["operator_kind"])
        subject = "sub-" + subjects.of(participant_of(recording), "participant")
        stem = f"{subject}_task-{tasks.of(recording.scene, 'task')}_tracksys-{systems.of(device, 'tracking system')}"
        runs[stem] = runs.get(stem, 0) + 1
        synthetic[subject] = synthetic.get(subject, False) or recording.synthetic
        folder = out / subject / "motion"
        folder.mkdir(parents=True, exist_ok=True)
        write_run(folder / f"{stem}_run-{runs[stem]}", recording, device)
    write(out / "participants.tsv", [["participant_id", "synthetic"], *([s, "yes" if made else "no"] for s, made in sorted(synthetic.items()))])
    write_json(out / "participants.json", {
        "participant_id": {"Description": "pseudonym of the participant"},
        "synthetic": {"Description": "whether motion of this participant was made by a performer, not by a person",
                      "Levels": {"yes": "made by a program", "no": "made by a person"}}})
    write_json(out / "dataset_description.json", {"Name": "Instrument motion of laparoscopic tasks", "BIDSVersion": "1.9.0", "DatasetType": "raw",
                                                  "GeneratedBy": [{"Name": "calot", "Version": calot.__version__}]})
    (out / "README").write_text(README, encoding="utf-8")
    if cohort:
        calot.record_export(cohort, "bids", out, [str(r.header["attempt_uuid"]) for r in recordings])


# %%
def option(name: str) -> str:
    """Takes an option and its value off the command line; empty: not given."""
    if name not in sys.argv[:-1]:
        return ""
    at = sys.argv.index(name)
    value = sys.argv[at + 1]
    del sys.argv[at:at + 2]
    return value


COHORT, KEY = option("--cohort"), option("--key")
if len(sys.argv) > 2:
    try:
        write_dataset(pathlib.Path(sys.argv[1]), [pathlib.Path(f) for f in sys.argv[2:]], COHORT, KEY)
    except (calot.Error, OSError) as error:
        fail(str(error))
elif len(sys.argv) == 2:
    fail("usage: bids_dataset.py OUT [--cohort C.db [--key KEY]] R.h5...")
else:
    with tempfile.TemporaryDirectory(prefix="calot-") as name:
        made = []
        for performer, seed in (("skilled", 1), ("skilled", 2), ("unskilled", 1)):
            made.append(pathlib.Path(name) / f"{performer}-{seed}.h5")
            calot.record(made[-1], "touch-liver", performer, seed=seed, seconds=1)
        write_dataset(pathlib.Path(name) / "bids", made)
        for path in sorted((pathlib.Path(name) / "bids").rglob("*")):
            if path.is_file():
                print(path.relative_to(name))
