// One residual for all solvers: how far impulses are from solving a contact problem.
#pragma once

#include <Eigen/Core>
#include <span>

#include "ourengine/contact/problem.hpp"
#include "ourengine/contact/system.hpp"

namespace ourengine {

enum class ContactLaw {
  kCoulomb,  // the exact law
  kConvex,   // without the shift mu |w_t| (Anitescu 2006): associated, slip lifts the contact
};

// The natural map of the law in velocity units, relative to the speeds of the problem:
//
//   max_i | F_i - P_K(F_i - w_i - mu |w_ti| e_n) |_inf / s,   F_i = A_i f_i,
//
// with A_i the normal entry of the Delassus operator J M^-1 J^T at contact i and P_K the projection
// on Coulomb's cone (Alart, Curnier 1991; Acary, Bremond, Huber 2018), and s the largest speed of
// bodies at a contact (ContactSystem::scale_mps). An impulse that the law does not want is off by
// as much as it moves the bodies, so residual times s bounds the error in m/s of each contact's own
// law; s is not max |J v_free + b|, which is rounding where an approach closes its gap exactly.
// Velocities are recomputed from the impulses, so that momentum holds exactly and no solver can be
// flattered by its own v. kConvex leaves out mu |w_ti|. With mu = 0 both are max |min(A_i f_i,
// w_i)|, the residual of the linear complementarity problem. Impulses that are not finite give
// infinity.
double contact_residual(const ContactProblem& problem, std::span<const Eigen::Vector3d> impulses_ns,
                        ContactLaw law = ContactLaw::kCoulomb);

// The same on a compiled system; w = J v + b of the velocity that belongs to f.
double contact_residual(const ContactSystem& system, const AlignedDoubles& f,
                        const AlignedDoubles& w, ContactLaw law);

// The same with v and w computed from f on the way.
double contact_residual_of(const ContactSystem& system, const AlignedDoubles& f, ContactLaw law,
                           AlignedDoubles& v, AlignedDoubles& w);

}  // namespace ourengine
