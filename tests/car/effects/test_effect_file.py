"""A Python file of the user is read, or refused with one error and its line."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import ModelError
from calib.car.effects.catalogue import with_own
from calib.car.effects.effect_file import read_own_effects, trial
from tests.support.effect_runs import made_motion
from tests.support.own_effects import EXAMPLE, MOMENT, retarder

CAR = trial("body_force", {})[0]


def refusal(tmp_path, text):
    """Return the message for a file of this text, without the name of its folder."""
    path = tmp_path / "mine.py"
    path.write_text(text)
    with pytest.raises(ModelError) as caught:
        read_own_effects([path])
    return str(caught.value).replace(f"{tmp_path}/", "")


def line_with(text, part):
    return 1 + next(i for i, line in enumerate(text.splitlines()) if part in line)


def test_the_example_is_the_force_of_its_equation():
    (effect,) = read_own_effects([EXAMPLE])
    assert (effect.name, effect.file) == ("air_brake_flap", "air_brake_flap.py")
    motion = made_motion([40.0, 20.0])
    history = replace(motion.history, p_mc=np.array([20e5, 0.0]))
    motion = replace(motion, history=history)
    force = effect.effect.body_force(CAR, {"flap_area": 0.5}, motion)
    assert force == pytest.approx([0.5 * 1.2 * 0.5 * 1600.0, 0.0], abs=0.01)


def test_what_a_file_prints_is_not_on_stdout(tmp_path, capsys):
    path = tmp_path / "a.py"
    path.write_text(retarder() + "\nprint('hello')\n")
    read_own_effects([path])
    assert capsys.readouterr() == ("", "hello\n")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ("return parameters['torqe'], 0.0", "KeyError"),
        ("motion.v[0] = 2.0", "read-only"),
        ("return None", "None"),
        ("return motion.v[1:], motion.v[1:]", "(399,)"),
        ("return motion.v, motion.v, motion.v", "(400,)"),
        ("return motion.v * np.nan, motion.v", "finite"),
        ("return 1.0 + 0.0 * motion.v, 0.0 * motion.v", "neutral"),
    ],
)
def test_a_wrong_hook_is_refused_with_its_line(tmp_path, body, words):
    text = retarder(body)
    message = refusal(tmp_path, text)
    raised = words in ("KeyError", "read-only")
    assert f"mine.py:{line_with(text, body if raised else 'def axle_moment')}: " in message
    assert words in message


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("EFFECT = ", "EFFECT = ((", "mine.py:7: SyntaxError"),
        ("EFFECT = Effect(", "EFFECT = 7\nMINE = Effect(", "EFFECT is 7"),
        ("import numpy as np", "raise SystemExit(0)", "mine.py:1: SystemExit"),
        ('name="rear_retarder"', 'name="hydraulic_lag"', "'hydraulic_lag'"),
        ('cause="a coil"', 'cause=" "', "empty"),
        ('"N*m"', '"bar"', "unit 'bar'"),
        ("900.0, 400.0", "9000.0, 400.0", "torque: not low"),
        ("900.0, 400.0", "0.0, 400.0", "neutral 0"),
        ("parameters=(", "neutral=-1.0, parameters=(", "neutral -1"),
        ("axle_moment=axle_moment,", "", "hook"),
        ("axle_moment=axle_moment", "axle_moment=7", "hook"),
    ],
)
def test_a_wrong_file_is_one_error_with_file_and_line(tmp_path, old, new, words):
    text = retarder()
    assert old in text
    message = refusal(tmp_path, text.replace(old, new))
    assert words in message
    assert message.startswith("mine.py")


def test_a_hook_that_fails_after_the_trial_is_an_error_with_its_line(tmp_path):
    """The hook fails only at speeds that the trial run does not reach."""
    text = retarder(f"assert motion.v.max() < 50.0; {MOMENT}")
    path = tmp_path / "mine.py"
    path.write_text(text)
    effect = read_own_effects([path])[0].effect
    effect.axle_moment(CAR, {"torque": 1.0}, made_motion([20.0]))
    line = line_with(text, "assert")
    with pytest.raises(ModelError, match=rf"mine\.py:{line}: axle_moment raises AssertionError"):
        effect.axle_moment(CAR, {"torque": 1.0}, made_motion([60.0]))


def test_two_files_cannot_define_one_effect(tmp_path):
    files = [tmp_path / name for name in ("one.py", "other.py")]
    for path in files:
        path.write_text(retarder())
    with pytest.raises(ModelError, match=r"also defined in one\.py"):
        with_own(CAR, read_own_effects(files))
