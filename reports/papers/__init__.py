"""What the papers print beside what is computed here: items, misprints, published values."""
