"""Whether a JSON document is what the page of the manual says."""

from jsonschema import Draft202012Validator

from calib.help.documents import documents


def missing_and_unknown(name: str, document: dict[str, object]) -> list[str]:
    """What is wrong with a document, in the judgement of another program's validator."""
    document = documents()[name]
    errors = [
        error.message for error in Draft202012Validator(document.schema).iter_errors(document)
    ]
    starts = tuple(key.removesuffix(" ...") for key in document.keys if " ..." in key)
    expected = {"schema", *document.keys}
    left = {
        key for key in document if key not in expected and not key.startswith(starts or ("\0",))
    }
    return errors + [f"{name}: the page has no key {key}" for key in sorted(left)]
