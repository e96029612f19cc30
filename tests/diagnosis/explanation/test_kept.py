"""A result is computed once for the same inputs, and again for others."""

from calib.diagnosis.explanation.kept import Kept


def test_a_result_is_computed_again_only_for_other_inputs():
    asked, kept = [], Kept()

    def of(inputs):
        return kept.of(inputs, lambda: asked.append(inputs) or 2 * inputs[0])

    assert [of((1,)), of((1,)), of((2,)), of((1,))] == [2, 2, 4, 2]
    assert asked == [(1,), (2,), (1,)]
