"""What a PLC logs of the plant: rate, jitter, skew, quantisation, noise, delay and drop-outs."""
