// The functions of OpenGL 3.3 that view uses, loaded when it runs: nothing is linked, so view
// starts where there is no OpenGL.
#pragma once

#include <GL/glcorearb.h>

namespace hapgrid {

// The type of glName is PFNGLNAMEPROC, which no macro can make of the name.
#define HAPGRID_GL_FUNCTIONS(F)                                \
  F(ActiveTexture, PFNGLACTIVETEXTUREPROC)                     \
  F(AttachShader, PFNGLATTACHSHADERPROC)                       \
  F(BindBuffer, PFNGLBINDBUFFERPROC)                           \
  F(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                 \
  F(BindRenderbuffer, PFNGLBINDRENDERBUFFERPROC)               \
  F(BindTexture, PFNGLBINDTEXTUREPROC)                         \
  F(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                 \
  F(BlendFunc, PFNGLBLENDFUNCPROC)                             \
  F(BlitFramebuffer, PFNGLBLITFRAMEBUFFERPROC)                 \
  F(BufferData, PFNGLBUFFERDATAPROC)                           \
  F(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)   \
  F(Clear, PFNGLCLEARPROC)                                     \
  F(ClearColor, PFNGLCLEARCOLORPROC)                           \
  F(CompileShader, PFNGLCOMPILESHADERPROC)                     \
  F(CreateProgram, PFNGLCREATEPROGRAMPROC)                     \
  F(CreateShader, PFNGLCREATESHADERPROC)                       \
  F(DeleteShader, PFNGLDELETESHADERPROC)                       \
  F(DepthFunc, PFNGLDEPTHFUNCPROC)                             \
  F(Disable, PFNGLDISABLEPROC)                                 \
  F(DrawArraysInstanced, PFNGLDRAWARRAYSINSTANCEDPROC)         \
  F(Enable, PFNGLENABLEPROC)                                   \
  F(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  F(FramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC) \
  F(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)       \
  F(GenBuffers, PFNGLGENBUFFERSPROC)                           \
  F(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                 \
  F(GenRenderbuffers, PFNGLGENRENDERBUFFERSPROC)               \
  F(GenTextures, PFNGLGENTEXTURESPROC)                         \
  F(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                 \
  F(GetIntegerv, PFNGLGETINTEGERVPROC)                         \
  F(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)             \
  F(GetProgramiv, PFNGLGETPROGRAMIVPROC)                       \
  F(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)               \
  F(GetShaderiv, PFNGLGETSHADERIVPROC)                         \
  F(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)           \
  F(LinkProgram, PFNGLLINKPROGRAMPROC)                         \
  F(PixelStorei, PFNGLPIXELSTOREIPROC)                         \
  F(ReadPixels, PFNGLREADPIXELSPROC)                           \
  F(RenderbufferStorage, PFNGLRENDERBUFFERSTORAGEPROC)         \
  F(ShaderSource, PFNGLSHADERSOURCEPROC)                       \
  F(TexImage2D, PFNGLTEXIMAGE2DPROC)                           \
  F(TexParameteri, PFNGLTEXPARAMETERIPROC)                     \
  F(Uniform2f, PFNGLUNIFORM2FPROC)                             \
  F(UseProgram, PFNGLUSEPROGRAMPROC)                           \
  F(VertexAttribDivisor, PFNGLVERTEXATTRIBDIVISORPROC)         \
  F(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)         \
  F(Viewport, PFNGLVIEWPORTPROC)

struct Gl {
#define HAPGRID_GL_MEMBER(name, type) type name;
  HAPGRID_GL_FUNCTIONS(HAPGRID_GL_MEMBER)
#undef HAPGRID_GL_MEMBER
};

/// Loads the functions of the current context. @throw Error when one is missing.
Gl load_gl();

}  // namespace hapgrid
