// Every macro that the host may set with -D, with its meaning and default. Nothing else is configurable.
#ifndef TRISTIM_CONFIG_H
#define TRISTIM_CONFIG_H

// Stack entries of the BVH traversal. The host sets it from the depth of the tree that it built.
#ifndef BVH_STACK_SIZE
#define BVH_STACK_SIZE 64
#endif

#endif
