"""The whole program on the sample logs: check, fit, validate, draw, the paper's two studies, and a
car in which something is hidden.

Section IV is judged against the truth of its simulation. Section V has no truth on the road: it
counts there whether the pad friction is as expected and the same in all stops on one road.
"""

import shutil
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from calib.base.arrays import Array
from calib.base.plain import counted, plus_minus
from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import read_vehicle
from calib.diagnosis.written import to_dict as document_of
from calib.estimation.agreement import Agreement, agreement
from calib.estimation.baselines import METHODS
from calib.estimation.limits import DEFAULTS
from calib.estimation.metrics import truth_of
from calib.estimation.results import to_dict, write_results
from calib.estimation.validate import Validation, validate
from calib.fitting.fit import fit
from calib.help.samples import sample_logs
from calib.logs.read import read_log
from calib.run.check import check
from calib.show.diagnosis import facts as diagnosis
from calib.show.facts import Facts, Table
from calib.store.store import Store
from calib.store.version import Stored

if TYPE_CHECKING:
    from calib.diagnosis.diagnosis import Diagnosis
    from calib.show.sheet import Sheet

_Say = Callable[[str], None]
_Row = dict[str, Any]
"""One of the JSON document."""


@dataclass(frozen=True)
class _Study:
    """One car of the samples: the logs that it is fitted on, and those that it is judged by."""

    fitted: str
    held_out: str
    vehicle: str = "vehicle.toml"


_STUDIES = {
    "sedan": _Study(
        "ramp_wet_asphalt.csv ramp_wet_asphalt_repeat.csv coast.csv",
        "dry_asphalt_stop.csv transition_dry_to_basalt.csv basalt_wet_pads.csv "
        "wet_tile_wet_pads.csv"
    ),
    "simulation_study": _Study("ramp_noisy.parquet", "stop_noisy.parquet",
                               "vehicle_wrong_pads.toml"),
    "third_party": _Study(
        "cal_ramp.parquet",
        "hold1_const_mu30.parquet hold2_steps_muf25_mur33.parquet hold3_const_fade35_22.parquet "
        "hold4_driver_mu28.parquet"
    )
}  # fmt: skip
_BEFORE = {"sedan": "ramp_wet_asphalt.csv"}
"""A ramp from which alone a car gets an earlier version."""


@dataclass(frozen=True)
class _Outcome:
    stored: Stored
    results: list[Validation]


def run(out: Path, say: _Say) -> tuple[dict[str, Any], Facts]:
    """Run all below ``out``: sample_logs/, tables/, results/, figures/, diagnosis/.

    Returns the JSON document, and the facts.
    """
    logs = out / "sample_logs"
    shutil.copytree(sample_logs(), logs, dirs_exist_ok=True)
    found = {name: _run(name, study, logs / name, out, say) for name, study in _STUDIES.items()}
    four = _section_four(found["simulation_study"])
    five = [_stop(one, found["sedan"].stored.table.vehicle) for one in found["sedan"].results]
    diagnosed, spreads = _hidden_story(out, say)
    document = {
        "folder": out,
        "diagnosis": document_of(diagnosed),
        "tables": [one.stored.id for one in found.values()],
        "section_4": four,
        "section_5": five,
    }
    return document, _facts(four, five, diagnosed, spreads, out)


def _run(name: str, study: _Study, source: Path, out: Path, say: _Say) -> _Outcome:
    """Check, fit, validate and draw one study."""
    from calib.show.choose import PlotInput, sheets

    fitted, held = (
        [read_log(source / file) for file in files.split()]
        for files in (study.fitted, study.held_out)
    )
    for log in fitted + held:
        usable = [v.purpose for v in check(log).verdicts if v.usable]
        say(f"checked {name}/{log.name}: good for {', '.join(usable)}")
    car, store = read_vehicle(source / "vehicle.toml"), Store(out / "tables")
    if name in _BEFORE:
        first = fit(car, [read_log(source / _BEFORE[name])])
        say(f"fitted {store.save(first).id} from {_BEFORE[name]} alone")
    stored = store.save(fit(car, fitted))
    say(f"fitted {stored.id} from {', '.join(log.name for log in fitted)}")
    other = None if study.vehicle == "vehicle.toml" else read_vehicle(source / study.vehicle)
    results = validate(stored.table, held, other, DEFAULTS)
    write_results(results, to_dict(stored, results), out / "results" / name)
    say(f"validated {stored.id} on {', '.join(log.name for log in held)}")
    ramps = tuple(log for log in fitted if "coast" not in log.name)
    _draw(sheets(PlotInput(tables=(stored,), logs=ramps)), out)
    _draw(sheets(PlotInput(tables=(stored,), logs=tuple(held), vehicle=other)), out)
    return _Outcome(stored, results)


def _draw(pages: "Iterable[Sheet]", out: Path) -> None:
    from calib.show.sheet import save

    folder = out / "figures"
    folder.mkdir(parents=True, exist_ok=True)
    save({folder / f"{sheet.name}.png": [sheet.overview()] for sheet in pages})


_METHODS = ("nominal", "mean_gain", "gradient_paper", "gradient_map")


def _section_four(outcome: _Outcome) -> list[_Row]:
    """The stop of Section IV by method: its final pad frictions, and the rms torque error [N m]
    over both axles from the first bite on.
    """
    e, car = outcome.results[0].estimate, outcome.stored.table.vehicle
    truth = truth_of(e)
    assert truth is not None
    braked = e.braked & (e.read.speed > 3.0) & np.isfinite(e.best.pads_f.value)
    last = int(np.flatnonzero(braked)[-1])
    pads = {name: METHODS[name](e) for name in _METHODS}
    pads["estimate"] = (e.best.pads_f.value, e.best.pads_r.value)
    rows = []
    for name, (front, rear) in pads.items():
        errors = [
            (mu * axle.torque_gain * p - torque)[braked]
            for mu, axle, p, torque in (
                (front, car.front, e.read.p_f, truth.torque[0]),
                (rear, car.rear, e.read.p_r, truth.torque[1]),
            )
        ]
        rms = float(np.sqrt(np.mean(np.square(np.concatenate(errors)))))
        pad_f, pad_r = float(front[last]), float(rear[last])
        rows.append({"method": name, "final_f": pad_f, "final_r": pad_r, "torque_rms": rms})
    return rows


def _stop(result: Validation, car: Vehicle) -> _Row:
    """A stop of Section V: pad friction with the half width of its 95 % interval, and the mean
    braking force over M a_x with nominal and with compensated pads [1].
    """
    e, figures = result.estimate, result.figures

    def share(front: Array, rear: Array) -> float:
        total = sum(
            2.0 * mu[e.valid] * axle.torque_gain * p[e.valid] / axle.rolling_radius
            for mu, axle, p in ((front, car.front, e.read.p_f), (rear, car.rear, e.read.p_r))
        )
        return float(np.mean(total / (car.weight * e.read.z[e.valid])))

    front, rear = (figures[f"pad_friction_{side}"] or np.nan for side in "fr")
    wide_f, wide_r = (figures[f"interval_{side}"] or np.nan for side in "fr")
    return {
        "log": result.log,
        "pads_f": front,
        "width_f": front * wide_f,
        "pads_r": rear,
        "width_r": rear * wide_r,
        "sum_nominal": share(*METHODS["nominal"](e)),
        "sum_compensated": share(e.best.pads_f.value, e.best.pads_r.value),
    }


def _hidden_story(out: Path, say: _Say) -> tuple["Diagnosis", list[Agreement]]:
    """Diagnose a car into ``out``/diagnosis, and draw it; also how its stops agree by a table
    without and with the model of the diagnosis.
    """
    from calib.car.model import with_model
    from calib.diagnosis.diagnose import diagnose
    from calib.diagnosis.written import text_of, write_folder
    from calib.show.diagnosis_page import report, sheet
    from calib.show.html import page_of

    source = out / "sample_logs" / "hidden/case_2"
    car = read_vehicle(source / "vehicle.toml")
    searched = [read_log(path) for path in sorted((source / "calibration").iterdir())]
    held = [read_log(path) for path in sorted((source / "holdout").iterdir())]
    logs = counted(len(searched), "log")
    say(f"diagnosing {car.name}: searching {logs}, proving on {len(held)}")
    found = diagnose(car, searched, held)
    write_folder(found, text_of(found), page_of(report(found, car.name)), out / "diagnosis")
    _draw([replace(sheet(found, car.name), name="diagnosis")], out)
    fitted = [log for log in searched if log.name in ("ramp", "coast")]
    pads = []
    for vehicle in (car, with_model(car, found.model_after)):
        spread = agreement(validate(fit(vehicle, fitted), held))
        assert spread is not None
        pads.append(spread)
    return found, pads


def _facts(
    four: list[_Row], five: list[_Row], diagnosed: "Diagnosis", spreads: list[Agreement], out: Path
) -> Facts:
    """The paper's two studies, the car with a hidden effect, and where all files are."""
    nominal = next(row["torque_rms"] for row in four if row["method"] == "nominal")
    methods = [
        (m["method"], f"{m['final_f']:.3f}", f"{m['final_r']:.3f}", f"{m['torque_rms']:.1f}",
         f"{nominal / m['torque_rms']:.1f} x")
        for m in four
    ]  # fmt: skip
    stops = [
        (s["log"], plus_minus(s["pads_f"], s["width_f"]), plus_minus(s["pads_r"], s["width_r"]),
         f"{s['sum_nominal']:.2f}", f"{s['sum_compensated']:.2f}")
        for s in five
    ]  # fmt: skip
    blind, told = (
        f"{100 * one.largest_departure_f:.1f} % front, {100 * one.largest_departure_r:.1f} % rear"
        for one in spreads
    )
    by_method = ("method", "final front", "final rear", "torque error [N m]", "better by")
    by_stop = ("stop", "front pads", "rear pads", "sum, nominal pads", "sum, compensated")
    return Facts(
        parts=[
            Facts(
                "Section IV: pads are 0.4, the vehicle file says 0.5 and 0.6",
                tables=[Table(by_method, methods)],
            ),
            Facts(
                "Section V: stops of the reference car, nominal pads 0.38",
                tables=[Table(by_stop, stops)],
                notes=["The last column is near 1 for any table; it validates nothing."],
            ),
            Facts(
                "A car with an effect that its vehicle file does not have",
                headline=diagnosis(diagnosed, "").headline,
                notes=[
                    f"Pads of the stops differ by up to {blind};",
                    f"with a table that accounts for it, by {told}.",
                ],
            ),
        ],
        rows=[
            *((name, str(out / name)) for name in ("tables", "results", "figures")),
            ("diagnosis", str(out / "diagnosis" / "report.html")),
        ],
    )
