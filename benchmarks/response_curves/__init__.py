"""Response curves of cables, their stability, basins and maps: response_curves.json; and the sweep of one's own line."""
