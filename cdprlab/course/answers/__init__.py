"""Around a student's answer: checks that speak to the student first, and results to go on with."""
