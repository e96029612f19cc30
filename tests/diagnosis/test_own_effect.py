"""An effect of one's own is searched for, named and added like those of the catalogue."""

import numpy as np
import pytest

from calib.car.effects.catalogue import with_own
from calib.car.effects.effect_file import read_own_effects
from calib.diagnosis.diagnose import diagnose
from calib.model.sensor_noise import add_noise
from calib.show.diagnosis import diagnosis_facts
from tests.support.hidden.cases import CARS, NOISE, run
from tests.support.hidden.plant import Car
from tests.support.hidden.settings import Hidden
from tests.support.own_effects import EXAMPLE
from tests.support.plant import magic

pytestmark = pytest.mark.slow

AREA = 0.7  # of the hidden flap [m^2]

UP = "up = 0.5 * (1.0 + np.tanh((motion.history.p_mc - OPENS) / 1e5))"
OF_THE_PLANT = "up = np.clip((motion.history.p_mc - 2e5) / 10e5, 0.0, 1.0)"


def test_a_flap_of_the_plant_is_named_by_the_effect_of_the_file(tmp_path):
    """A file that opens the flap as the plant does, linear from 2 to 12 bar."""
    file = tmp_path / EXAMPLE.name
    text = EXAMPLE.read_text()
    assert UP in text
    file.write_text(text.replace(UP, OF_THE_PLANT))
    rng, hidden = np.random.default_rng(4711), Hidden(flap_area=AREA)
    car = Car(CARS[1], magic(26.0, 1.0, curvature=-0.1), (0.95, 1.05), hidden=hidden)
    names = ("coast", "ramp", "release", "step_high", "stop_a", "stop_b")
    logs = [add_noise(run(car, name, rng), i, NOISE) for i, name in enumerate(names)]
    (flap,) = read_own_effects([file])
    diagnosis = diagnose(with_own(CARS[1], [flap]), logs[:4], logs[4:])
    assert diagnosis.verdict == "named"
    assert [effect.name for effect in diagnosis.effects] == ["air_brake_flap"]
    assert diagnosis.effects[0].parameters["flap_area"].value == pytest.approx(AREA, rel=0.1)
    assert diagnosis.effects[0].where.axle == "body"
    assert diagnosis.gap.closed > 0.85
    assert dict(diagnosis_facts(diagnosis).parts[0].rows)["Cause"] == flap.effect.card.cause
