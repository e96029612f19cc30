"""Whether a JSON document is what the page of the manual says."""

from jsonschema import Draft202012Validator

from calib.help.documents import documents


def missing_and_unknown(name: str, document: dict[str, object]) -> list[str]:
    """What is wrong with a document, in the judgement of another program's validator."""
    page = documents()[name]
    errors = [error.message for error in Draft202012Validator(page.schema).iter_errors(document)]
    starts = tuple(key.removesuffix(" ...") for key in page.keys if " ..." in key)
    keys = {"schema", *page.keys}
    unknown = {key for key in document if key not in keys and not key.startswith(starts or "\0")}
    return errors + [f"{name}: the page has no key {key}" for key in sorted(unknown)]
