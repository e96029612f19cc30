"""The picture and the page of a result in a notebook, which `calib` gives to every `Viewable`."""

from html import escape

from calib.base.viewable import Viewable
from calib.diagnosis.diagnosis import Diagnosis
from calib.estimation.estimator import Estimate
from calib.estimation.validate import Validation
from calib.show.choose import sheet_facts
from calib.show.diagnosis import diagnosis_facts
from calib.show.diagnosis_figure import diagnosis_sheet
from calib.show.html import page_of
from calib.show.sheet import Sheet
from calib.show.stop import of_estimate, of_validation
from calib.show.style import Figure
from calib.show.table import table_sheet
from calib.store.version import Stored
from calib.table.table import Table

_FRAME = '<iframe srcdoc="{}" title="{}" style="border: 0; width: 100%; height: 40rem"></iframe>'


def plot(result: Viewable) -> Figure:
    """Return the picture of a result."""
    return _sheet(result).overview()


def page(result: Viewable) -> str:
    """Return the page of a result, in a frame that keeps its style from the notebook."""
    if isinstance(result, Diagnosis):
        facts = diagnosis_facts(result)
    else:
        facts = sheet_facts([_sheet(result)])
    return _FRAME.format(escape(page_of(facts)), escape(facts.title))


def _sheet(result: Viewable) -> Sheet:
    match result:
        case Stored():
            return table_sheet(result.table, result.id)
        case Table():
            return table_sheet(result, result.name)
        case Estimate():
            return of_estimate(result)
        case Validation():
            return of_validation(result)
        case Diagnosis():
            return diagnosis_sheet(result)
    raise TypeError(f"{type(result).__name__} has no picture")
