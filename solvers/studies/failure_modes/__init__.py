"""Where methods fail: each study computes the numbers, and knows what theory says of them."""
