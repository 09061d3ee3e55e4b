"""What moving lines consist of: segments, meshes, numbering, parts, coarser lines, and their arrays."""
