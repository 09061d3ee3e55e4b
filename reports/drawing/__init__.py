"""What every figure shares: style, data behind it, drawing in forked processes."""
