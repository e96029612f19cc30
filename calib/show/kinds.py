"""Which facts a result has: its kind picks the function that tells it, here and nowhere else.

    facts_of(result) -> Facts, for a terminal and for a page

A module is imported only for a result of its kind.
"""

from importlib import import_module

from calib.show.facts import Facts

_FACTS = {
    "Diagnosis": "diagnosis_page:facts",
    "Fitted": "fit:facts",
    "GaugeStudy": "repeatability:facts",
    "StationRun": "station_page:facts",
    "Stored": "store:shown",
    "Summary": "fleet_page:facts",
    "Validated": "validation:facts",
    "Vehicle": "vehicle:facts",
}
"""The function of each kind of result, by the name of its class."""


def facts_of(result: object) -> Facts:
    """The facts of a result; facts are their own. Raises KeyError for a kind that has none."""
    if isinstance(result, Facts):
        return result
    module, _, name = _FACTS[type(result).__name__].partition(":")
    found: Facts = getattr(import_module(f"calib.show.{module}"), name)(result)
    return found
