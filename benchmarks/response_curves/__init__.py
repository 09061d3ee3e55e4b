"""Response curves of cables, their stability, basins and maps; the sweep of one's own line."""
