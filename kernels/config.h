// Every macro that the host may set with -D, with its meaning and default. Nothing else is configurable.
#ifndef TRISTIM_CONFIG_H
#define TRISTIM_CONFIG_H

// Stack entries of the BVH traversal. The host sets it from the depth of the tree that it built.
#ifndef BVH_STACK_SIZE
#define BVH_STACK_SIZE 64
#endif

// Children of a BVH node and triangles of a leaf, which are tested at once: 8, 4 or 2. The host builds the tree so wide as its table
// of devices says (host/opencl/device_table.cpp).
#ifndef BVH_WIDTH
#define BVH_WIDTH 8
#endif

// What the scene calls for (host/render/effects.h); an effect that is off leaves no code.
#ifndef HAS_DIELECTRIC
#define HAS_DIELECTRIC 0
#endif
#ifndef HAS_DISPERSION
#define HAS_DISPERSION 0  // a dielectric whose index depends on the wavelength: paths may keep one slot
#endif
#ifndef HAS_CONDUCTOR
#define HAS_CONDUCTOR 0
#endif
#ifndef HAS_FILM
#define HAS_FILM 0  // a thin film: paths may be coloured
#endif
#ifndef HAS_ABSORBING_FILM
#define HAS_ABSORBING_FILM 0  // a film with a layer that absorbs
#endif
#ifndef HAS_COATED_DIFFUSE
#define HAS_COATED_DIFFUSE 0  // a film on a diffuse surface
#endif
#ifndef HAS_ROUGH
#define HAS_ROUGH 0  // a rough dielectric or conductor
#endif
#ifndef HAS_ROUGH_PHOTONS
#define HAS_ROUGH_PHOTONS 0  // one that is rough enough to take photons (SurfaceMaterial::takes_photons)
#endif
#ifndef HAS_NEARLY_SPECULAR
#define HAS_NEARLY_SPECULAR 0  // one that is not
#endif
#ifndef HAS_ANISOTROPIC
#define HAS_ANISOTROPIC 0  // one whose roughness depends on the direction
#endif
#ifndef HAS_TEXTURE
#define HAS_TEXTURE 0  // a texture in use
#endif
#ifndef HAS_UV
#define HAS_UV 0  // surface coordinates u and v: for textures mapped by them and for HAS_ANISOTROPIC
#endif
#ifndef HAS_SHADING_NORMALS
#define HAS_SHADING_NORMALS 0  // a mesh with vertex normals
#endif
#ifndef HAS_THIN_LENS
#define HAS_THIN_LENS 0  // a camera with a lens radius
#endif
#ifndef HAS_POINT_LIGHT
#define HAS_POINT_LIGHT 0
#endif
#ifndef HAS_SPOT_LIGHT
#define HAS_SPOT_LIGHT 0
#endif
#ifndef HAS_DISTANT_LIGHT
#define HAS_DISTANT_LIGHT 0
#endif
#ifndef HAS_INFINITE_LIGHT
#define HAS_INFINITE_LIGHT 0
#endif
#ifndef HAS_AREA_LIGHT
#define HAS_AREA_LIGHT 0
#endif

// Surfaces that are not diffuse, and kinds of lights: of what there is only one kind, none is looked up.
#define HAS_SPECULAR (HAS_DIELECTRIC || HAS_CONDUCTOR)
#define LIGHT_KINDS (HAS_POINT_LIGHT + HAS_SPOT_LIGHT + HAS_DISTANT_LIGHT + HAS_INFINITE_LIGHT + HAS_AREA_LIGHT)

// Wavelengths: the pass's table has W of them, padded to W_PADDED = BLOCKS·LANES with wavelengths of weight zero. Paths
// carry BLOCKS vectors of LANES floats.
#ifndef W
#define W 3
#endif
#ifndef LANES
#define LANES 4  // 4, 8 or 16
#endif
#ifndef BLOCKS
#define BLOCKS 1
#endif
#define W_PADDED (LANES * BLOCKS)

// The sampler that fills the table, a file of kernels/samplers/: read by wavelengths.cl alone.
#define SAMPLER_TRISTIMULUS 0
#define SAMPLER_SPECTRAL 1
#define SAMPLER_RGB 2
#define SAMPLER_GAUSS 3
#define SAMPLER_UNIFORM 4
#define SAMPLER_CLUSTER 5
#define SAMPLER_HERO 6
#define SAMPLER_VISIBLE 7
#define SAMPLER_MIXTURE 8
#define SAMPLER_ILLUMINANT 9
#ifndef SAMPLER
#define SAMPLER SAMPLER_TRISTIMULUS
#endif
#ifndef SEQUENCE_RANDOM
#define SEQUENCE_RANDOM 0  // 1: new random numbers in each pass (the paper); 0: stratified within and over the passes
#endif

// Camera paths may carry a throughput of its own for every wavelength.
#define COLOURED_EYE (HAS_CONDUCTOR || HAS_FILM || HAS_ROUGH)
// Photons keep the flux of every wavelength beside XYZ: needed where camera paths may depend on the wavelength.
#define STORE_SPECTRAL_FLUX (HAS_DISPERSION || COLOURED_EYE)

// Vertices after which a path ends.
#ifndef MAX_DEPTH
#define MAX_DEPTH 16
#endif

// 1: photons count from their first hit and direct light is not sampled (--direct photons).
#ifndef DIRECT_PHOTONS
#define DIRECT_PHOTONS 0
#endif

// 1: radii follow Hachisuka et al. 2008's statistics of each pixel; 0: Knaus & Zwicker 2011's schedule for all.
#ifndef RADIUS_STATISTICS
#define RADIUS_STATISTICS 0
#endif

// 1: photons are also gathered within radius/√2, and sums are kept from which noise and bias of the pixels are estimated
// (host/render/error_estimate.h).
#ifndef ERROR_ESTIMATE
#define ERROR_ESTIMATE 0
#endif

// Photon paths that one work-item traces, one after the other, into a piece of the photon buffer of its own.
#ifndef PATHS_PER_ITEM
#define PATHS_PER_ITEM 64
#endif

// Bits of a sort key that one pass of the radix sort looks at.
#ifndef RADIX_BITS
#define RADIX_BITS 9
#endif

// 1: every ray that is traced is also written to a buffer, for `tristim bench-pass`.
#ifndef RECORD_RAYS
#define RECORD_RAYS 0
#endif

// 1: the device may end loops before they are done (see loops.h).
#ifndef LOOPS_END_EARLY
#define LOOPS_END_EARLY 0
#endif

// 0: the device has no fused multiply-add, and fma() is slow (see multiply_add.h).
#ifndef HAS_FMA
#define HAS_FMA 1
#endif

// 1: built with -cl-fast-relaxed-math.
#ifndef FAST_MATH
#define FAST_MATH 0
#endif

// Intel's compiler would run several work-items in one vector and take our vectors of wavelengths and boxes apart: eye paths took 2.4
// times as long on it.
#ifdef cl_intel_vec_len_hint
#define kernel __kernel __attribute__((intel_vec_len_hint(1)))
#endif

#endif
