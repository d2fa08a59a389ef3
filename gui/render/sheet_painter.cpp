// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/sheet_painter.h"

#include <cstddef>

#include "gui/render/fibre_texture.h"

namespace calot::gui {

SheetPainter::SheetPainter(const GlFunctions& gl, int fibreUnit)
    : gl_(gl), fibreUnit_(static_cast<GLenum>(GL_TEXTURE0 + fibreUnit)) {
  gl_.GenVertexArrays(1, &vertexArray_);
  gl_.GenBuffers(1, &vertexBuffer_);
  gl_.GenBuffers(1, &indexBuffer_);
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_);
  GLuint attribute = 0;
  const auto give = [&](GLint size, std::size_t offset) {
    gl_.EnableVertexAttribArray(attribute);
    gl_.VertexAttribPointer(attribute++, size, GL_FLOAT, GL_FALSE, sizeof(SheetVertex),
                            reinterpret_cast<const void*>(offset));
  };
  give(3, offsetof(SheetVertex, position));
  give(3, offsetof(SheetVertex, normal));
  give(3, offsetof(SheetVertex, along));
  give(4, offsetof(SheetVertex, look));
  give(1, offsetof(SheetVertex, erosion));

  const std::vector<std::uint8_t> texels = makeFibreTexture();
  gl_.GenTextures(1, &fibres_);
  gl_.ActiveTexture(fibreUnit_);
  gl_.BindTexture(GL_TEXTURE_2D, fibres_);
  gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, fibreColumns, fibreRows, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels.data());
  gl_.GenerateMipmap(GL_TEXTURE_2D);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_NEAREST);
  gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

SheetPainter::~SheetPainter() {
  gl_.DeleteTextures(1, &fibres_);
  gl_.DeleteBuffers(1, &vertexBuffer_);
  gl_.DeleteBuffers(1, &indexBuffer_);
  gl_.DeleteVertexArrays(1, &vertexArray_);
}

void SheetPainter::draw(const SheetList& list) const {
  gl_.ActiveTexture(fibreUnit_);  // new targets may have been bound to it
  gl_.BindTexture(GL_TEXTURE_2D, fibres_);
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.vertex.size() * sizeof(SheetVertex)), list.vertex.data(),
                 GL_STREAM_DRAW);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(list.index.size() * sizeof(std::uint32_t)),
                 list.index.data(), GL_STREAM_DRAW);
  // Colours come multiplied by their opacity; the list is in order of depth, and hides nothing itself.
  gl_.Enable(GL_BLEND);
  gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  gl_.DepthMask(GL_FALSE);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(list.index.size()), GL_UNSIGNED_INT, nullptr);
  gl_.DepthMask(GL_TRUE);
  gl_.Disable(GL_BLEND);
}

}  // namespace calot::gui
