import re
from dataclasses import replace

from calib.plausibility.check import check
from calib.run.run import Run
from calib.show.check import check_facts


def test_a_log_with_gaps_names_the_part_to_cut_out(ramp):
    time = ramp.time
    is_kept = ((time < 1.0) | (time > 1.3)) & ((time < 8.0) | (time > 8.4))
    channels = {name: values[is_kept] for name, values in ramp.channels.items()}
    findings = check(replace(ramp, channels=channels))
    start, end = map(float, re.findall(r"--(?:from|until) ([\d.]+)", check_facts([findings]).next))
    is_in_part = (channels["time"] >= start) & (channels["time"] <= end)
    assert 6.5 < end - start < 6.9
    cut = replace(ramp, channels={name: values[is_in_part] for name, values in channels.items()})
    assert not Run(cut).clock.gaps
    assert not check_facts([findings, findings]).next  # the next step of a single log only
