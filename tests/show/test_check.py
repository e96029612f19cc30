import re
from dataclasses import replace

from calib.plausibility.check import check
from calib.run.run import Run
from calib.show.check import check_facts


def test_a_log_with_gaps_is_told_how_to_cut_it(ramp):
    time = ramp.time
    stays = ((time < 1.0) | (time > 1.3)) & ((time < 8.0) | (time > 8.4))
    kept = {name: values[stays] for name, values in ramp.channels.items()}
    findings = check(replace(ramp, channels=kept))
    start, end = map(float, re.findall(r"--(?:from|until) ([\d.]+)", check_facts([findings]).next))
    part = (kept["time"] >= start) & (kept["time"] <= end)
    assert 6.5 < end - start < 6.9
    cut = replace(ramp, channels={name: values[part] for name, values in kept.items()})
    assert not Run(cut).clock.gaps
    assert not check_facts([findings, findings]).next  # of several logs, -v says it of each
