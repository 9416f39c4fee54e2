#include "render/flat_texture.h"

#include "base/error.h"

#include <algorithm>
#include <limits>

namespace tristim {

SceneTexture flatten_texture(const Texture& texture, const V3d& origin, std::vector<float>& texels) {
    SceneTexture flat{};
    flat.kind = texture.kind == Texture::Kind::Image ? TEXTURE_IMAGE : TEXTURE_BILINEAR;
    switch (texture.mapping) {
    case Texture::Mapping::Uv:
        flat.mapping = MAPPING_UV;
        break;
    case Texture::Mapping::Planar:
        flat.mapping = MAPPING_PLANAR;
        break;
    case Texture::Mapping::Spherical:
        flat.mapping = MAPPING_SPHERICAL;
        break;
    case Texture::Mapping::Cylindrical:
        flat.mapping = MAPPING_CYLINDRICAL;
        break;
    }
    switch (texture.wrap) {
    case Texture::Wrap::Repeat:
        flat.wrap = WRAP_REPEAT;
        break;
    case Texture::Wrap::Clamp:
        flat.wrap = WRAP_CLAMP;
        break;
    case Texture::Wrap::Black:
        flat.wrap = WRAP_BLACK;
        break;
    }
    flat.width = texture.width;
    flat.height = texture.height;
    flat.outside = static_cast<float>(texture.outside);
    std::transform(texture.corners.begin(), texture.corners.end(), flat.corners,
                   [](double value) { return static_cast<float>(value); });
    if (texture.mapping == Texture::Mapping::Uv) {
        flat.to_texture[0] = static_cast<float>(texture.uv_scale[0]);
        flat.to_texture[5] = static_cast<float>(texture.uv_scale[1]);
        flat.to_texture[3] = static_cast<float>(texture.uv_scale[2]);
        flat.to_texture[7] = static_cast<float>(texture.uv_scale[3]);
    } else {
        const M44d to_texture = M44d().setTranslation(origin) * texture.world_to_texture;
        // Imath multiplies row vectors, the kernels column vectors.
        for (int row = 0; row < 3; ++row) {
            for (int column = 0; column < 4; ++column)
                flat.to_texture[4 * row + column] = static_cast<float>(to_texture[column][row]);
        }
    }
    if (texels.size() + texture.texels.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        fail("the textures of the scene have more than {} texels together", std::numeric_limits<int>::max());
    flat.first_texel = static_cast<int>(texels.size());
    texels.insert(texels.end(), texture.texels.begin(), texture.texels.end());
    return flat;
}

} // namespace tristim
