"""What the program is used for, what may go wrong, and what would show it.

The tables that ISO 26262-8 asks for in its clause 11, confidence in the use of software tools: use
cases, possible malfunctions with their effects, and the measures that detect them.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Malfunction:
    """``what`` may go wrong, its ``effect``, the ``measure`` in use, the ``checks`` made here."""

    what: str
    effect: str
    measure: str
    checks: tuple[str, ...]


@dataclass(frozen=True)
class UseCase:
    """A command with its input and output, and its possible malfunctions."""

    name: str
    about: str
    malfunctions: tuple[Malfunction, ...]


USE_CASES = (
    UseCase(
        "read",
        "A log becomes signals in SI units.",
        (
            Malfunction(
                "A unit, a separator or a decimal sign is misread.",
                "All pads are wrong by one factor.",
                "The command check prints source, unit and factor of each channel; pads outside "
                "0.05 to 1 are refused.",
                ("unit_psi", "read_units", "read_dialect"),
            ),
            Malfunction(
                "A damaged or incomplete file is taken for a whole one.",
                "The table rests on a part of the run.",
                "Sizes, counts and footers are compared; exit code 3.",
                ("broken_logs", "broken_bus_logs", "broken_mdf"),
            ),
            Malfunction(
                "A signal of a bus, or a channel of another rate, is decoded or timed wrongly.",
                "Pressure, speeds and acceleration do not belong together.",
                "The notes of check name the DBC and what was interpolated.",
                ("read_asc", "read_blf", "read_log", "read_mf4"),
            ),
        ),
    ),
    UseCase(
        "fit",
        "Ramps and coast logs become a table f1(eta), f2(eta) with pad friction.",
        (
            Malfunction(
                "A formula of the paper or a routine under it computes a wrong number.",
                "The table, and every torque made with it, is wrong.",
                "Validation on hold-outs; warnings pads_off_file, pad_ratio.",
                ("brake_torque", "axle_load", "constraint", "fit_pads_f", "fit_pads_r",
                 "fit_body_pads_f", "fit_body_pads_r"),
            ),
            Malfunction(
                "The split between the axles is wrong, the sum right.",
                "The torque moves from one axle to the other; the sum of forces does not show it.",
                "Bands of the table; validation on hold-outs that have torques or other pads.",
                ("fit_split",),
            ),
            Malfunction(
                "The spread of several cars is wrong.",
                "A golden table is too strict or too lax.",
                "Intervals of tables merge.",
                ("spread_of_cars",),
            ),
        ),
    ),
    UseCase(
        "validate",
        "A table is judged on logs that it has not seen.",
        (
            Malfunction(
                "The estimator finds wrong pads.",
                "A good table fails, or a bad one passes.",
                "Agreement of several stops; the methods of the paper beside it.",
                ("adaptive_law", "stop_mu30_f", "stop_mu30_r", "stop_mu25_mu33_f",
                 "stop_mu25_mu33_r", "stop_mu28_f", "stop_mu28_r", "stop_wrong_file_f",
                 "stop_wrong_file_r", "stop_torque"),
            ),
            Malfunction(
                "The interval is too narrow.",
                "A result is trusted more than it deserves.",
                "Share of the truth in the interval where the log has truth.",
                ("stop_interval",),
            ),
            Malfunction(
                "A result that breaks a limit, or rests on the logs of the fit, is called passed.",
                "A wrong table is released.",
                "Every limit with value and verdict in summary.json; release with reason and "
                "evidence.",
                ("verdict",),
            ),
        ),
    ),
    UseCase(
        "station",
        "A car at the line gets its table, a verdict and the state of the table.",
        (
            Malfunction(
                "A car that breaks a limit passes, or a good one fails.",
                "A wrong table is released, or a good car is held back.",
                "Every limit with value and verdict in station.json and on the page.",
                ("station_verdicts",),
            ),
            Malfunction(
                "A log of the fit is taken for proof.",
                "The verdict rests on nothing.",
                "Such a log is refused; exit code 3.",
                ("station_holdout",),
            ),
        ),
    ),
    UseCase(
        "batch",
        "Many logs are judged in worker processes.",
        (
            Malfunction(
                "A row has the result of another log, or of another table.",
                "Cars are sorted by wrong numbers.",
                "Each row has the SHA-256 of its log.",
                ("batch_pads",),
            ),
            Malfunction(
                "A damaged log ends the batch, or has a result.",
                "Logs are missing, or a result rests on a part of a run.",
                "A row with status error and the message; counts at the end.",
                ("batch_rows",),
            ),
        ),
    ),
    UseCase(
        "export",
        "A version is stored and written for calibration tools and ECUs.",
        (
            Malfunction(
                "A number is rounded, cut off or put under another label.",
                "The ECU computes with another table than the one that was validated.",
                "A checksum of the numbers in each file; tables import compares with the store.",
                ("export_csv", "export_dcm", "export_cdfx", "export_c_header"),
            ),
            Malfunction(
                "A stored version or an export that was changed afterwards is accepted.",
                "A table is used that nobody validated.",
                "SHA-256 of each version, tables verify, signatures; exit code 4.",
                ("damaged_tables",),
            ),
        ),
    ),
    UseCase(
        "diagnose",
        "The effect is named that separates the car from its model.",
        (
            Malfunction(
                "A wrong cause is named, or the right one with a wrong size.",
                "A wrong effect is taken out of later logs.",
                "Replay of hold-outs before and after; effects that cannot be told apart are "
                "listed.",
                ("drag_named", "drag_size", "lag_named", "lag_size"),
            ),
            Malfunction(
                "A cause is named where there is none.",
                "Time is lost, and a sound model is changed.",
                "Verdict no_gap; what does not help on hold-outs is withdrawn.",
                ("no_cause",),
            ),
        ),
    ),
)  # fmt: skip
"""In the order of the work."""
