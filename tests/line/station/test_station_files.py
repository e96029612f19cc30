"""The date of an export at the station: that of storing the table, on every later day as well."""

from datetime import UTC, datetime

from calib.show import station_page as write
from calib.show.station_page import store_and_write
from calib.store.store import Store


def test_the_same_run_a_day_later_has_the_same_date(found, tmp_path, monkeypatch):
    dates = []
    monkeypatch.setattr(
        write, "write_all", lambda f, stored, forms, date, work: dates.append(date) or {}
    )
    (tmp_path / write.DOCUMENT).write_text("{}")
    store = Store(tmp_path / "tables")
    stored, _ = store_and_write(found, store, ["cdfx"], "", tmp_path)
    assert dates == [datetime.now(UTC).date().isoformat()]

    class Later(datetime):
        @classmethod
        def now(cls, tz=None):
            return datetime(2099, 1, 1, tzinfo=tz)

    monkeypatch.setattr(write, "datetime", Later)
    again, _ = store_and_write(found, store, ["cdfx"], "", tmp_path)
    assert again.id == stored.id
    assert dates[1] == store.load(stored.id).state.stored_at[:10] == dates[0]
    store_and_write(found, store, ["cdfx"], "2025-03-31", tmp_path)
    assert dates[2] == "2025-03-31"
