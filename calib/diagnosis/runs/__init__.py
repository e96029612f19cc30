"""The logs of a diagnosis, each by itself: judged, made even, refused or warned of."""
