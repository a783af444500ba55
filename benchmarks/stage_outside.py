"""What programs that nobody here wrote say of stages: USD's validators, NVIDIA's, a physics engine.

    python benchmarks/stage_outside.py HOUSE.usda ... --usd
    python benchmarks/stage_outside.py HOUSE.usda ... --validator ENVIRONMENT/bin/python
    python benchmarks/stage_outside.py HOUSE.usda ... --still ENVIRONMENT/bin/python simcheck.py
    python benchmarks/stage_outside.py HOUSE.usda ... --mujoco

The second and third want environments of their own: `pip install 'usd-validation-nvidia[usd]'`, and
`pip install 'newton[importers,sim]'` for a script that exits 0 if every body of a stage stays where
it is for two seconds. `--mujoco` exports each house and asks the same of the model. `--jointed`:
with all that opens opened up. `--told FILE` keeps what was told, so that a run can be resumed.

The validator's own command is run for every stage and every set of rules, all in one process, since
most of its time goes into starting. It looks at a stage once for every combination of variants,
which for a house of seven rooms and twenty pieces is forty times as often as the house has prims:
six minutes of processor time. `--as-they-stand` leaves that out.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from results import write_section

RULES = {
    "default rules": ("--disable-rule", "IndexedPrimvarChecker"),
    "atomic_asset": ("--no-init-rules", "--capability", "com.nvidia.usd.atomic_asset"),
}
"""What the validator is asked, by the name of the row."""

_VALIDATE = """
import json, sys
from usd_validation_nvidia import cli_main
rules, stages = json.loads(sys.argv[1])
for stage in stages:
    sys.argv = ["nvidia_usd_validate", *rules, stage]
    try:
        code = cli_main() or 0
    except SystemExit as error:
        code = error.code or 0
    print("\\nTOLD " + json.dumps([stage, code]), flush=True)
"""

_LINES_SHOWN = 12

_STILL_S, _STRAY_M, _STRAY_RAD = 2.0, 0.01, 0.1
"""What stands still moves and turns less, in so long."""


def main() -> None:
    """Asks, and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stages", type=Path, nargs="+")
    parser.add_argument("--usd", action="store_true", help="ask all of USD's own validators")
    parser.add_argument("--validator", type=Path, metavar="PYTHON")
    parser.add_argument("--still", type=Path, nargs=2, metavar=("PYTHON", "SCRIPT"))
    parser.add_argument("--mujoco", action="store_true", help="ask MuJoCo of the exported model")
    parser.add_argument("--jointed", action="store_true", help="open up all that opens")
    parser.add_argument("--kind", default="houses", help="what the stages are (houses)")
    parser.add_argument("--as-they-stand", action="store_true", help="do not try every variant")
    parser.add_argument("--told", type=Path, metavar="FILE", help="resume from here")
    options = parser.parse_args()
    if options.jointed:
        options.stages = [_opened(stage) for stage in options.stages]
        options.kind += ", jointed"
    _ask(options)


def _ask(options: argparse.Namespace) -> None:
    if options.usd:
        log = _Log(options.told, "UsdValidation")
        log.extend(_asked_usd(log.missing(options.stages)))
        rows = [("no errors and nothing missing", log.row(options.stages))]
        title = f"stages: UsdValidation, {options.kind}"
        sys.stdout.write(write_section(title, rows, _note(options)))
    if options.validator:
        rows = []
        for name, rules in RULES.items():
            asked = [*rules, *(["--no-variants"] if options.as_they_stand else [])]
            log = _Log(options.told, name)
            log.extend(_validated(options.validator, asked, log.missing(options.stages)))
            rows.append((name, log.row(options.stages)))
        title = f"stages: NVIDIA's validator, {options.kind}"
        sys.stdout.write(write_section(title, rows, _note(options)))
    if options.still:
        log = _Log(options.told, "still")
        log.extend(_stood(options.still, log.missing(options.stages)))
        rows = [("stand still for two seconds", log.row(options.stages))]
        title = f"stages: physics, {options.kind}"
        sys.stdout.write(write_section(title, rows, _note(options)))
    if options.mujoco:
        log = _Log(options.told, "mujoco")
        log.extend(_stood_in_mujoco(log.missing(options.stages)))
        rows = [("stand still for two seconds", log.row(options.stages))]
        title = f"stages: MuJoCo, {options.kind}"
        sys.stdout.write(write_section(title, rows, _note(options)))


def _opened(stage: Path) -> Path:
    """An override beside a stage in which all pieces are jointed that can be."""
    from pxr import Sdf, Usd

    from chord_usd.base.scene.articulation import ARTICULATION, JOINTED

    path = stage.with_name(f"{stage.stem}_jointed.usda")
    path.unlink(missing_ok=True)
    opened = Usd.Stage.CreateNew(str(path))
    opened.GetRootLayer().subLayerPaths = [f"./{stage.name}"]
    source = Sdf.Layer.FindOrOpen(str(stage))
    opened.GetRootLayer().defaultPrim = source.defaultPrim
    for key in ("upAxis", "metersPerUnit", "kilogramsPerUnit"):
        opened.SetMetadata(key, source.pseudoRoot.GetInfo(key))
    for prim in list(opened.Traverse()):
        choice = prim.GetVariantSets().GetVariantSet(ARTICULATION)
        if JOINTED in choice.GetVariantNames():
            choice.SetVariantSelection(JOINTED)
    opened.Save()
    return path


class _Log:
    """Exit codes by question and stage, kept in a file of JSON lines if there is one."""

    def __init__(self, file: Path | None, question: str) -> None:
        self._file, self._question = file, question
        self._codes: dict[str, int] = {}
        if file and file.exists():
            for line in file.read_text().splitlines():
                asked, stage, code = json.loads(line)
                if asked == question:
                    self._codes[stage] = code

    def missing(self, stages: Sequence[Path]) -> list[Path]:
        """Those of the stages that were not asked about yet."""
        return [stage for stage in stages if str(stage) not in self._codes]

    def extend(self, told: Iterator[tuple[str, int, str]]) -> None:
        """Note (stage, exit code, text) one by one."""
        for stage, code, text in told:
            self._codes[stage] = code
            if self._file:
                with self._file.open("a") as file:
                    file.write(json.dumps([self._question, stage, code]) + "\n")
            sys.stderr.write(f"{self._question}, {stage}: {code}\n")
            if code:
                sys.stderr.write("\n".join(text.strip().splitlines()[-_LINES_SHOWN:]) + "\n")
            sys.stderr.flush()

    def row(self, stages: Sequence[Path]) -> str:
        """How many of the stages pass."""
        passed = sum(self._codes.get(str(stage)) == 0 for stage in stages)
        return f"{passed} of {len(stages)} pass"


def _asked_usd(stages: Sequence[Path]) -> Iterator[tuple[str, int, str]]:
    """What the validators that come with USD say of each stage, and what it cannot resolve."""
    from pxr import Usd, UsdUtils, UsdValidation

    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    for stage in stages:
        errors = [one.GetMessage() for one in context.Validate(Usd.Stage.Open(str(stage)))]
        missing = [str(path) for path in UsdUtils.ComputeAllDependencies(str(stage))[2]]
        yield str(stage), int(bool(errors or missing)), "\n".join([*errors, *missing])


def _validated(
    python: Path, rules: Sequence[str], stages: Sequence[Path]
) -> Iterator[tuple[str, int, str]]:
    """What the validator says of each stage."""
    if not stages:
        return
    asked = json.dumps([list(rules), [str(stage) for stage in stages]])
    run = subprocess.Popen(
        [str(python), "-c", _VALIDATE, asked],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert run.stdout is not None
    said = ""
    for line in run.stdout:
        if line.startswith("TOLD "):
            yield (*json.loads(line.removeprefix("TOLD ")), said)
            said = ""
        else:
            said += line
    if run.wait():
        raise RuntimeError(f"the validator ended with {run.returncode}")


def _stood(command: Sequence[Path], stages: Sequence[Path]) -> Iterator[tuple[str, int, str]]:
    """What the script about standing still says of each stage."""
    for stage in stages:
        run = subprocess.run(
            [*map(str, command), str(stage)], capture_output=True, text=True, check=False
        )
        yield str(stage), run.returncode, run.stdout + run.stderr


def _stood_in_mujoco(stages: Sequence[Path]) -> Iterator[tuple[str, int, str]]:
    """Which bodies of the exported model moved, and how many could."""
    import mujoco
    import numpy as np

    from chord_usd.line.stage.export.export_stage import export_stage

    for stage in stages:
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "model"
            export_stage(stage, folder, "mujoco")
            model = mujoco.MjModel.from_xml_path(str(folder / "model.xml"))
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        at, turned = data.xpos.copy(), data.xquat.copy()
        for _ in range(round(_STILL_S / model.opt.timestep)):
            mujoco.mj_step(model, data)
        moved_m = np.linalg.norm(data.xpos - at, axis=1)
        turned_rad = 2 * np.arccos(np.clip(abs((data.xquat * turned).sum(axis=1)), 0, 1))
        astray = (moved_m > _STRAY_M) | (turned_rad > _STRAY_RAD)
        names = [model.body(int(index)).name for index in np.flatnonzero(astray)]
        movable = int((model.body_dofnum > 0).sum())
        sys.stderr.write(f"{movable} bodies can move, at most by {1000 * moved_m.max():.1f} mm\n")
        warned = sum(warning.number for warning in data.warning)
        yield str(stage), int(bool(names or warned)), "\n".join(names)


def _note(options: argparse.Namespace) -> str:
    first, last = (Path(*stage.parts[-2:]) for stage in (options.stages[0], options.stages[-1]))
    return f"{first} to {last}{', as they stand' * options.as_they_stand}."


if __name__ == "__main__":
    main()
