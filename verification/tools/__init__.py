"""What tests share: observed orders, derivatives by complex step, random draws."""
