// the serial arm
