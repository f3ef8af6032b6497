// forward, inverse, Jacobian of the Falcon
