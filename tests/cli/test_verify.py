"""`brake-cal tables verify`."""


def test_verify_passes_a_sound_store(tables, two, document):
    ran = tables("verify", "--json")
    assert ran.code == 0
    assert document(ran)["sound"] is True
    assert [v["id"] for v in document(tables("verify", "wagon", "--json"))["versions"]] == [
        "wagon@1"
    ]


def test_verify_ends_with_4_and_says_where(tables, two, document):
    path = two / "sedan" / "v0001" / "paper.parquet"
    path.write_bytes(path.read_bytes()[:-1])
    ran = tables("verify", "--json")
    assert ran.code == 4
    verdicts = document(ran)["versions"]
    assert [v["sound"] for v in verdicts] == [False, True, True]
    assert "paper.parquet" in verdicts[0]["violations"][0]
    ran = tables("verify")
    assert ran.code == 4
    assert "paper.parquet" in ran.out
    assert tables("verify", "wagon").code == 0
