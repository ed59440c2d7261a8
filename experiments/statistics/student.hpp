// Student's distribution and the normal one.
#pragma once

namespace brickbench::statistics {

// P(X <= x) of the normal distribution with mean 0 and deviation 1.
double normal_cdf(double x);

// P(T <= t) for Student's distribution with `freedom` > 0 degrees of freedom, by the incomplete
// beta function (NIST Digital Library of Mathematical Functions, 8.17.22).
double student_cdf(double t, double freedom);
// The t with student_cdf(t, freedom) = probability, 0 < probability < 1.
double student_quantile(double probability, double freedom);

}  // namespace brickbench::statistics
