"""What every room uses: outcomes and errors, validated data, motion, outputs of a moving line, diagnostics."""
