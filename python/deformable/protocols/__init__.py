"""What is done to a packing: jamming, compression, shear, moduli, motion."""
