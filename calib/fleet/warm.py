"""Imported once by the server that workers are forked off, so that each is ready at once."""

import calib.check
import calib.fit
import calib.fleet.work
import calib.validate  # noqa: F401
