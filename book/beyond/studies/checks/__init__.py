"""Later checks of studies beside: published weights, wiring by joint, training that is chosen."""
