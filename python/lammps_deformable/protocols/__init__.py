"""Protocols: jamming, compression, shear, moduli, motion."""
