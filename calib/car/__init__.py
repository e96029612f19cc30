"""The equations of car, wheel, tyre and brake; each is written once."""
