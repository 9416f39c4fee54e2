#pragma once

#include "selftest/case.h"

namespace tristim::selftest {

/// What the cases of two groups measure, on programs that may be given: a test tries them on kernels with a fault.
namespace photon {

/// Of kernels/selftest/photon.cl.
::cl::Program build_cores(const Setting& setting);
Measurement known_answers(const Setting& setting, const ::cl::Program& cores);
Measurement finite_values(const Setting& setting, const ::cl::Program& cores);
Measurement radius_of_passes(const Setting& setting, const ::cl::Program& cores);
Measurement density(const Setting& setting, const ::cl::Program& cores);

/// Of kernels/gather.cl as a render of a grey scene builds it.
Macros gather_macros();
::cl::Program build_gather(const Setting& setting);
Measurement gather_everywhere(const Setting& setting, const ::cl::Program& gather);
Measurement many_photons(const Setting& setting, const ::cl::Program& gather);
Measurement faint_photons(const Setting& setting, const ::cl::Program& gather);

} // namespace photon

namespace accumulation {

/// Of kernels/selftest/accumulation.cl, never with relaxed math.
Macros film_macros();
::cl::Program build_film(const Setting& setting);
Measurement sums(const Setting& setting, const ::cl::Program& film);
Measurement squares(const Setting& setting, const ::cl::Program& film);
Measurement magnitudes(const Setting& setting, const ::cl::Program& film);
Measurement large_samples(const Setting& setting, const ::cl::Program& film);
Measurement counts(const Setting& setting, const ::cl::Program& film);
Measurement statistics_radius(const Setting& setting, const ::cl::Program& film);

} // namespace accumulation
} // namespace tristim::selftest
