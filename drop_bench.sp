
small 1.0 inf 0 tension 1.0
large 1.2 inf 0 tension 1.0

